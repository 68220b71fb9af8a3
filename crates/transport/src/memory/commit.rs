//! Committed pages: shared memory that is there when it is written to.
//!
//! The system provides a page of a segment when it is first touched; where it has none left, it ends the process with
//! SIGBUS. So a process that creates a port first asks for free space, and then takes all pages of the port.

use std::{
    fs::{File, OpenOptions},
    io::{Error, ErrorKind, Result},
    os::unix::fs::{MetadataExt, OpenOptionsExt},
    path::Path,
    time::{Duration, Instant},
};

use rustix::{
    fs::{FallocateFlags, OFlags, fallocate},
    io::Errno,
};

use super::{segments::files, unfinished::UNFINISHED_AGE};
use crate::{Domain, process_id};

/// Takes all pages of the segments of a port, so that no later write to them can fail. Returns their size in bytes.
///
/// Cost: the system clears each page.
///
/// # Errors
/// [`ErrorKind::StorageFull`] where there is no room; drop the port then.
pub fn commit(domain: &Domain, port_id: u128) -> Result<u64> {
    commit_first(domain, port_id, u64::MAX)
}

/// As [`commit`], but at most the first `most` bytes of each segment, for ports with room for more samples than are in
/// use at a time: iceoryx2 hands out samples from the front.
///
/// # Errors
/// As [`commit`].
pub fn commit_first(domain: &Domain, port_id: u128, most: u64) -> Result<u64> {
    let port = port_id.to_string();
    let mut bytes = 0;
    for (path, _, name) in files(domain)? {
        // Connections of the port have its id in their names as well; both sides write to them.
        if process_id::parts(&name).any(|part| part == port) {
            match open_finished(&path) {
                Ok(file) => bytes += commit_file(&file, &path, most)?,
                // Other processes create and remove files meanwhile.
                Err(error) if error.kind() == ErrorKind::NotFound => {}
                Err(error) => return Err(error),
            }
        }
    }
    Ok(bytes)
}

/// Opens a segment. A peer may be creating it, as a connection to a port of this process: then it can't be read for a
/// moment.
fn open_finished(path: &Path) -> Result<File> {
    let patience = Instant::now() + UNFINISHED_AGE;
    let flags = OFlags::NOFOLLOW.bits().cast_signed();
    loop {
        match OpenOptions::new().read(true).write(true).custom_flags(flags).open(path) {
            Err(error) if error.kind() == ErrorKind::PermissionDenied && Instant::now() < patience => {
                std::thread::sleep(Duration::from_millis(1));
            }
            other => return other,
        }
    }
}

fn commit_file(file: &File, path: &Path, most: u64) -> Result<u64> {
    let metadata = file.metadata()?;
    let length = metadata.len().min(most);
    if length == 0 || metadata.blocks().saturating_mul(512) >= metadata.len() {
        return Ok(length);
    }
    loop {
        match fallocate(file, FallocateFlags::empty(), 0, length) {
            Ok(()) => return Ok(length),
            Err(Errno::INTR) => {}
            Err(error) => {
                let error = Error::from(error);
                return Err(Error::new(error.kind(), format!("{}: {error}", path.display())));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{super::FOLDER, *};

    #[test]
    fn commit_takes_all_pages_of_the_port_and_reports_full_storage() {
        let domain = Domain::new(&format!("memory-{}", std::process::id()), None, 7).unwrap();
        // A number inside the prefix or inside another id is not the port's id.
        let path = Path::new(FOLDER).join(format!("{}0abc77_1771_1234.data", domain.prefix()));
        let file = File::create(&path).unwrap();
        file.set_len(1 << 20).unwrap();
        assert_eq!(file.metadata().unwrap().blocks(), 0, "no page was touched yet");
        assert_eq!(commit(&domain, 77).unwrap(), 0, "another port's segment");
        assert_eq!(commit_first(&domain, 1234, 8192).unwrap(), 8192);
        assert_eq!(file.metadata().unwrap().blocks(), 16);
        let committed = commit(&domain, 1234);
        let blocks = file.metadata().unwrap().blocks();
        // A size that no system has: an error, not a signal.
        file.set_len(1 << 50).unwrap();
        let refused = commit(&domain, 1234).unwrap_err();
        std::fs::remove_file(&path).unwrap();
        assert_eq!((committed.unwrap(), blocks), (1 << 20, 2048));
        assert_eq!(refused.kind(), ErrorKind::StorageFull, "{refused}");
    }
}
