//! Files of a domain in shared memory: which there are, free space, and permissions.

use std::{
    fs::{Metadata, Permissions},
    io::{ErrorKind, Result},
    os::unix::fs::{MetadataExt, PermissionsExt},
    path::PathBuf,
};

use crate::Domain;

/// The folder in which shared memory segments are files.
pub const FOLDER: &str = "/dev/shm";

/// The files of a domain that belong to this user, each with its name behind the domain's prefix. Names that are not
/// UTF-8 are left out, and so are links: everybody can put one here.
///
/// # Errors
/// An I/O error of [`FOLDER`].
pub(crate) fn files(domain: &Domain) -> Result<impl Iterator<Item = (PathBuf, Metadata, String)>> {
    let prefix = domain.prefix();
    let uid = rustix::process::getuid().as_raw();
    Ok(std::fs::read_dir(FOLDER)?.flatten().filter_map(move |entry| {
        let name = entry.file_name().to_str()?.strip_prefix(prefix)?.to_owned();
        // Other processes create and remove files meanwhile.
        let metadata = entry.metadata().ok().filter(|metadata| metadata.is_file() && metadata.uid() == uid)?;
        Some((entry.path(), metadata, name))
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
    for (path, metadata, _) in files(domain)? {
        if metadata.mode() & 0o077 != 0 {
            match std::fs::set_permissions(path, Permissions::from_mode(metadata.mode() & 0o700)) {
                Err(error) if error.kind() != ErrorKind::NotFound => return Err(error),
                _ => {}
            }
        }
    }
    Ok(())
}
