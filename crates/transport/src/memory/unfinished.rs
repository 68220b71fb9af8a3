//! Unfinished segments: files that a peer was creating when it crashed.

use std::{io::Result, os::unix::fs::MetadataExt, time::Duration};

use super::segments::files;
use crate::{
    Domain,
    process_id::{self, ProcessId},
};

/// Longest time that a live process takes to create a segment; see [`remove_unfinished`].
pub const UNFINISHED_AGE: Duration = Duration::from_millis(200);

/// The mode by which iceoryx2 marks a file that is still being created: its owner may write, and nobody read.
const UNFINISHED: u32 = 0o200;

/// Removes segments that crashed peers were still creating; returns their number. No tag of a node names such a
/// segment, so that the cleanup of dead nodes does not remove it, and iceoryx2 0.10 waits without end for a segment
/// that has no length yet.
///
/// A file counts as unfinished if it is still marked as being created, was not written to for `age`, and one of the
/// processes whose ids its name carries is gone. The age protects processes of other namespaces, whose ids can't be
/// seen from here.
///
/// Cost: one system call for each file of the domain.
///
/// # Errors
/// An I/O error of [`FOLDER`](super::FOLDER).
pub fn remove_unfinished(domain: &Domain, age: Duration) -> Result<usize> {
    let mut removed = 0;
    for (path, metadata, name) in files(domain)? {
        let is_old = metadata.modified().is_ok_and(|written| written.elapsed().is_ok_and(|since| since >= age));
        if metadata.mode() & 0o777 == UNFINISHED && is_old && process_id::in_name(&name).any(ProcessId::is_gone) {
            removed += usize::from(std::fs::remove_file(path).is_ok());
        }
    }
    Ok(removed)
}

#[cfg(test)]
mod tests {
    use std::{
        fs::{File, Permissions},
        os::unix::fs::PermissionsExt,
        path::Path,
    };

    use super::{super::FOLDER, *};

    #[test]
    fn remove_unfinished_removes_old_files_of_dead_processes_only() {
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
        let unfinished = [
            make(format!("{}.event_mgmt", id(dead)), UNFINISHED),
            make(format!("{}_{}.connection", id(dead), id(living)), UNFINISHED),
        ];
        let kept = [
            make(format!("{}.dynamic", id(dead)), 0o600),
            make(format!("{}__1.data", id(living)), UNFINISHED),
            make("1.data".into(), UNFINISHED),
        ];
        let exist = |paths: &[std::path::PathBuf]| paths.iter().filter(|path| path.exists()).count();
        let too_young = (remove_unfinished(&domain, Duration::from_secs(3600)).unwrap(), exist(&unfinished));
        let removed = remove_unfinished(&domain, Duration::ZERO).unwrap();
        let counts = (exist(&unfinished), exist(&kept));
        for path in unfinished.iter().chain(&kept) {
            let _ = std::fs::remove_file(path);
        }
        assert_eq!((too_young, removed, counts), ((0, 2), 2, (0, 3)));
    }
}
