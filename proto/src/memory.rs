//! Shared memory that is there when it is written to.
//!
//! The system hands out the pages of a segment when they are first touched, and where it has none left it ends the process with SIGBUS.
//! So whoever makes a port asks first whether there is room, and then takes all of it.

use std::{
    fs::{File, OpenOptions},
    io::{Error, ErrorKind, Result},
    os::unix::fs::MetadataExt,
    path::Path,
};

use rustix::{
    fs::{FallocateFlags, fallocate},
    io::Errno,
};

use crate::Domain;

/// Where segments are files.
pub const FOLDER: &str = "/dev/shm";

/// Free shared memory in bytes.
///
/// # Errors
/// What the system says about [`FOLDER`].
pub fn free() -> Result<u64> {
    let stat = rustix::fs::statvfs(FOLDER)?;
    Ok(stat.f_bavail.saturating_mul(stat.f_frsize))
}

/// Takes all pages of the segments of a port, so that no later write to them can fail. Returns their bytes.
///
/// Cost: the system clears each page.
///
/// # Errors
/// [`ErrorKind::StorageFull`] where there is no room; drop the port then.
pub fn commit(domain: &Domain, port_id: u128) -> Result<u64> {
    let port = port_id.to_string();
    let mut bytes = 0;
    for entry in std::fs::read_dir(FOLDER)?.flatten() {
        let name = entry.file_name();
        let Some(name) = name.to_str() else { continue };
        // Connections of the port have its id in their names as well, and are written to by both sides.
        if name.starts_with(domain.prefix()) && name.contains(&port) {
            match OpenOptions::new().read(true).write(true).open(entry.path()) {
                Ok(file) => bytes += commit_file(&file, &entry.path())?,
                // Others may come and go.
                Err(error) if error.kind() == ErrorKind::NotFound => {}
                Err(error) => return Err(error),
            }
        }
    }
    Ok(bytes)
}

fn commit_file(file: &File, path: &Path) -> Result<u64> {
    let metadata = file.metadata()?;
    if metadata.blocks().saturating_mul(512) >= metadata.len() {
        return Ok(metadata.len());
    }
    loop {
        match fallocate(file, FallocateFlags::empty(), 0, metadata.len()) {
            Ok(()) => return Ok(metadata.len()),
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
    use super::*;

    #[test]
    fn a_segment_is_taken_whole() {
        let domain = Domain::new(&format!("memory-{}", std::process::id()), None, 7).unwrap();
        let path = Path::new(FOLDER).join(format!("{}{}.data", domain.prefix(), 1234));
        let file = File::create(&path).unwrap();
        file.set_len(1 << 20).unwrap();
        assert_eq!(file.metadata().unwrap().blocks(), 0, "nothing was touched yet");
        assert_eq!(commit(&domain, 77).unwrap(), 0, "another port's");
        let committed = commit(&domain, 1234);
        let blocks = file.metadata().unwrap().blocks();
        // A size that no system has: the error is a word, not a signal.
        file.set_len(1 << 50).unwrap();
        let refused = commit(&domain, 1234).unwrap_err();
        std::fs::remove_file(&path).unwrap();
        assert_eq!((committed.unwrap(), blocks), (1 << 20, 2048));
        assert_eq!(refused.kind(), ErrorKind::StorageFull, "{refused}");
    }
}
