//! Shared memory that is there when it is written to.
//!
//! The system hands out the pages of a segment when they are first touched, and where it has none left it ends the process with SIGBUS.
//! So whoever makes a port asks first whether there is room, and then takes all of it.

use std::{
    fs::{File, OpenOptions, Permissions},
    io::{Error, ErrorKind, Result},
    os::unix::fs::{MetadataExt, PermissionsExt},
    path::Path,
    time::{Duration, Instant},
};

use rustix::{
    fs::{FallocateFlags, fallocate},
    io::Errno,
    process::{Pid, test_kill_process},
};

use crate::Domain;

/// Where segments are files.
pub const FOLDER: &str = "/dev/shm";

/// A segment that is still being made after this long is not being made any more: [`remove_unfinished`].
pub const UNFINISHED_AGE: Duration = Duration::from_millis(200);

/// How iceoryx2 marks a file that is still being made: its owner may write, and nobody read.
const UNFINISHED: u32 = 0o200;

/// Free shared memory in bytes.
///
/// # Errors
/// What the system says about [`FOLDER`].
pub fn free() -> Result<u64> {
    let stat = rustix::fs::statvfs(FOLDER)?;
    Ok(stat.f_bavail.saturating_mul(stat.f_frsize))
}

/// Closes what iceoryx2 leaves open to other users: the file with its version number. Others that make nodes know it already.
///
/// # Errors
/// What the system says.
pub fn close_to_others(domain: &Domain) -> Result<()> {
    for entry in std::fs::read_dir(FOLDER)?.flatten() {
        let ours = entry.file_name().as_encoded_bytes().starts_with(domain.prefix().as_bytes());
        let Ok(metadata) = entry.metadata() else { continue };
        if ours && metadata.is_file() && metadata.mode() & 0o077 != 0 {
            match std::fs::set_permissions(entry.path(), Permissions::from_mode(metadata.mode() & 0o700)) {
                Err(error) if error.kind() != ErrorKind::NotFound => return Err(error),
                _ => {}
            }
        }
    }
    Ok(())
}

/// Removes what processes left that were killed while they made it: no node knows of it, so that the cleaning of dead nodes leaves it behind,
/// and iceoryx2 0.10 waits without end for a segment that has no length yet. Returns how many files.
///
/// A file counts as left if it is still marked as being made, was not written to for `age`, and one of the processes whose ids its name
/// carries is gone. The age protects processes whose ids can't be seen from here.
///
/// Cost: one look at each file of the domain.
///
/// # Errors
/// What the system says about [`FOLDER`].
pub fn remove_unfinished(domain: &Domain, age: Duration) -> Result<usize> {
    let mut removed = 0;
    for entry in std::fs::read_dir(FOLDER)?.flatten() {
        let name = entry.file_name();
        let Some(name) = name.to_str().and_then(|name| name.strip_prefix(domain.prefix())) else { continue };
        // Others may come and go.
        let Ok(metadata) = entry.metadata() else { continue };
        let is_old = metadata.modified().is_ok_and(|written| written.elapsed().is_ok_and(|since| since >= age));
        if metadata.is_file()
            && metadata.mode() & 0o777 == UNFINISHED
            && is_old
            && processes(name).any(ProcessId::is_gone)
        {
            removed += usize::from(std::fs::remove_file(entry.path()).is_ok());
        }
    }
    Ok(removed)
}

/// A process, as the ids of its nodes and ports carry it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ProcessId(Pid);

impl ProcessId {
    /// From the id of a node or port: seconds, nanoseconds, process and counter, 32 bits each, from the lowest.
    #[must_use]
    pub fn of(id: u128) -> Option<Self> {
        i32::try_from((id >> 64) & u128::from(u32::MAX)).ok().and_then(Pid::from_raw).map(Self)
    }

    /// Whether the system knows no such process, as far as it can be seen from here.
    #[must_use]
    pub fn is_gone(self) -> bool {
        test_kill_process(self.0) == Err(Errno::SRCH)
    }
}

/// The processes in the ids that the name of a file of iceoryx2 carries.
pub fn processes(name: &str) -> impl Iterator<Item = ProcessId> {
    parts(name).filter_map(|part| ProcessId::of(part.parse().ok()?))
}

/// Ids stand whole between these: an id must not be found inside another, nor in the prefix.
fn parts(name: &str) -> impl Iterator<Item = &str> {
    name.split(['_', '.'])
}

/// Takes all pages of the segments of a port, so that no later write to them can fail. Returns their bytes.
///
/// Cost: the system clears each page.
///
/// # Errors
/// [`ErrorKind::StorageFull`] where there is no room; drop the port then.
pub fn commit(domain: &Domain, port_id: u128) -> Result<u64> {
    commit_first(domain, port_id, u64::MAX)
}

/// As [`commit`], but no more than the first so many bytes of each segment: for ports with room for more than is ever used at a time.
/// Samples are handed out from the front.
///
/// # Errors
/// As [`commit`].
pub fn commit_first(domain: &Domain, port_id: u128, most: u64) -> Result<u64> {
    let port = port_id.to_string();
    let mut bytes = 0;
    for entry in std::fs::read_dir(FOLDER)?.flatten() {
        let name = entry.file_name();
        let Some(name) = name.to_str().and_then(|name| name.strip_prefix(domain.prefix())) else { continue };
        // Connections of the port have its id in their names as well, and are written to by both sides.
        if parts(name).any(|part| part == port) {
            match open_finished(&entry.path()) {
                Ok(file) => bytes += commit_file(&file, &entry.path(), most)?,
                // Others may come and go.
                Err(error) if error.kind() == ErrorKind::NotFound => {}
                Err(error) => return Err(error),
            }
        }
    }
    Ok(bytes)
}

/// Opens a segment. The peer may be just making it, a connection to a port of ours: then nobody may read it yet, but only for a moment.
fn open_finished(path: &Path) -> Result<File> {
    let patience = Instant::now() + UNFINISHED_AGE;
    loop {
        match OpenOptions::new().read(true).write(true).open(path) {
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
    use super::*;

    #[test]
    fn what_was_left_unfinished_goes() {
        let domain = Domain::new(&format!("unfinished-{}", std::process::id()), None, 7).unwrap();
        let mut child = std::process::Command::new("true").spawn().unwrap();
        let dead = child.id();
        child.wait().unwrap();
        let living = std::process::id();
        let id = |process: u32| ((u128::from(process) << 64) | 99).to_string();
        let make = |name: String, mode: u32| {
            let path = Path::new(FOLDER).join(format!("{}0abc_{name}", domain.prefix()));
            File::create(&path).unwrap();
            std::fs::set_permissions(&path, Permissions::from_mode(mode)).unwrap();
            path
        };
        let left = [
            make(format!("{}.event_mgmt", id(dead)), UNFINISHED),
            make(format!("{}_{}.connection", id(dead), id(living)), UNFINISHED),
        ];
        let kept = [
            make(format!("{}.dynamic", id(dead)), 0o600),
            make(format!("{}__1.data", id(living)), UNFINISHED),
            make("1.data".into(), UNFINISHED),
        ];
        let exist = |paths: &[std::path::PathBuf]| paths.iter().filter(|path| path.exists()).count();
        let too_young = (remove_unfinished(&domain, Duration::from_secs(3600)).unwrap(), exist(&left));
        let removed = remove_unfinished(&domain, Duration::ZERO).unwrap();
        let counts = (exist(&left), exist(&kept));
        for path in left.iter().chain(&kept) {
            let _ = std::fs::remove_file(path);
        }
        assert_eq!((too_young, removed, counts), ((0, 2), 2, (0, 3)));
    }

    #[test]
    fn a_segment_is_taken_whole() {
        let domain = Domain::new(&format!("memory-{}", std::process::id()), None, 7).unwrap();
        // What the prefix or another id holds is not the port.
        let path = Path::new(FOLDER).join(format!("{}0abc77_1771_1234.data", domain.prefix()));
        let file = File::create(&path).unwrap();
        file.set_len(1 << 20).unwrap();
        assert_eq!(file.metadata().unwrap().blocks(), 0, "nothing was touched yet");
        assert_eq!(commit(&domain, 77).unwrap(), 0, "another port's");
        assert_eq!(commit_first(&domain, 1234, 8192).unwrap(), 8192);
        assert_eq!(file.metadata().unwrap().blocks(), 16);
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
