//! Files of a domain in shared memory: which there are, free space, and permissions.

use std::{
    fs::{DirEntry, Permissions},
    io::{ErrorKind, Result},
    os::unix::fs::{MetadataExt, PermissionsExt},
};

use crate::Domain;

/// The folder in which shared memory segments are files.
pub const FOLDER: &str = "/dev/shm";

/// The files of a domain, each with its name behind the domain's prefix. Names that are not UTF-8 are left out.
///
/// # Errors
/// An I/O error of [`FOLDER`].
pub(crate) fn files(domain: &Domain) -> Result<impl Iterator<Item = (DirEntry, String)>> {
    let prefix = domain.prefix();
    Ok(std::fs::read_dir(FOLDER)?.flatten().filter_map(move |entry| {
        let name = entry.file_name().to_str()?.strip_prefix(prefix)?.to_owned();
        Some((entry, name))
    }))
}

/// Free shared memory in bytes.
///
/// # Errors
/// An I/O error of [`FOLDER`].
pub fn free() -> Result<u64> {
    let stat = rustix::fs::statvfs(FOLDER)?;
    Ok(stat.f_bavail.saturating_mul(stat.f_frsize))
}

/// Removes the permissions of other users from all files of a domain. iceoryx2 leaves one file open to them, the one
/// with its version number. Call this after the first node was created: later nodes find that file.
///
/// # Errors
/// An I/O error of [`FOLDER`] or of a file in it.
pub fn close_to_others(domain: &Domain) -> Result<()> {
    for (entry, _) in files(domain)? {
        let Ok(metadata) = entry.metadata() else { continue };
        if metadata.is_file() && metadata.mode() & 0o077 != 0 {
            match std::fs::set_permissions(entry.path(), Permissions::from_mode(metadata.mode() & 0o700)) {
                Err(error) if error.kind() != ErrorKind::NotFound => return Err(error),
                _ => {}
            }
        }
    }
    Ok(())
}
