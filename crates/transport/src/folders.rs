//! Private folders: made and checked so that no other user can have put something in their place.
//!
//! `/tmp` is everybody's: another user may have made a folder there before this one comes, or a link.

use std::{
    fs::{DirBuilder, Metadata, Permissions},
    io::ErrorKind,
    os::unix::fs::{DirBuilderExt, MetadataExt, PermissionsExt},
    path::{Path, PathBuf},
};

use thiserror::Error;

/// Why a folder can't be used.
#[derive(Debug, Error)]
pub enum FolderError {
    /// It could not be made or looked at.
    #[error("folder {path}: {source}")]
    System {
        /// The folder.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// Something else is in its place, or another user's folder, or one that others may write to.
    #[error(
        "{path} must be a folder of user {uid} that no other user can write to, but it {found}; remove it, or set \
         XDG_RUNTIME_DIR to a folder of this user"
    )]
    Foreign {
        /// The folder.
        path: PathBuf,
        /// This user.
        uid: u32,
        /// What it is instead, in words.
        found: String,
    },
}

/// Creates a folder where it is missing, and checks that it belongs to this user alone.
pub(crate) fn create(path: &Path) -> Result<(), FolderError> {
    let failed = |source| FolderError::System { path: path.to_owned(), source };
    match DirBuilder::new().mode(0o700).create(path) {
        Ok(()) => {}
        Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
        // The folder that `XDG_RUNTIME_DIR` names need not exist.
        Err(error) if error.kind() == ErrorKind::NotFound => {
            DirBuilder::new().recursive(true).mode(0o700).create(path).map_err(failed)?;
        }
        Err(error) => return Err(failed(error)),
    }
    let metadata = check(path)?;
    // iceoryx2 changes the umask of the process for a moment when it creates a listener; a child that is started at
    // that moment inherits the changed umask.
    if metadata.mode() & 0o777 != 0o700 {
        std::fs::set_permissions(path, Permissions::from_mode(0o700)).map_err(failed)?;
    }
    Ok(())
}

/// Checks that a folder exists, is no link, belongs to this user, and that no other user can write to it.
pub(crate) fn check(path: &Path) -> Result<Metadata, FolderError> {
    let metadata =
        std::fs::symlink_metadata(path).map_err(|source| FolderError::System { path: path.to_owned(), source })?;
    let (uid, owner, mode) = (rustix::process::getuid().as_raw(), metadata.uid(), metadata.mode() & 0o777);
    let found = if metadata.is_symlink() {
        "is a link".to_owned()
    } else if !metadata.is_dir() {
        "is no folder".to_owned()
    } else if owner != uid {
        format!("belongs to user {owner}")
    } else if mode & 0o022 != 0 {
        format!("has mode {mode:03o}")
    } else {
        return Ok(metadata);
    };
    Err(FolderError::Foreign { path: path.to_owned(), uid, found })
}
