//! A domain: a private corner of iceoryx2 in which one daemon and its clients meet.
//!
//! A domain has a name. Its root folder is `$XDG_RUNTIME_DIR/untangled/NAME`, or `/tmp/untangled-UID/NAME` where that
//! variable is not set; its shared memory has the prefix `untangled-UID-HASH-`, where HASH stands for the root folder.
//! Different names never meet.

use std::path::{Path, PathBuf};

use iceoryx2::prelude::{Config, FileName, SemanticString};
use thiserror::Error;

use crate::folders::{self, FolderError};

/// Environment variable with the name of the domain, where none is given.
pub const DOMAIN_VARIABLE: &str = "UNTANGLED_DOMAIN";
/// The name of the folder of all domains below `XDG_RUNTIME_DIR`.
pub(crate) const FOLDER_NAME: &str = "untangled";
/// The domain where none is chosen.
pub const DEFAULT_DOMAIN: &str = "default";
/// Longest name of a domain in bytes.
pub const MAX_NAME_BYTES: usize = 24;
/// Longest root path in bytes: the names of sockets below it must not grow beyond what the system takes.
pub const MAX_ROOT_BYTES: usize = 60;

/// Why a domain can't be used.
#[derive(Debug, Error)]
pub enum DomainError {
    /// A name with other characters, or too long.
    #[error("domain name `{name}` must have 1 to {MAX_NAME_BYTES} of the characters a-z, A-Z, 0-9, `-` and `_`")]
    Name {
        /// The name.
        name: String,
    },
    /// The root folder's path is too long.
    #[error(
        "the path {path} has {length} bytes, but sockets below it only work up to {MAX_ROOT_BYTES}: \
         choose a shorter domain name \
         or set XDG_RUNTIME_DIR to a shorter folder"
    )]
    RootTooLong {
        /// The path.
        path: PathBuf,
        /// Its length.
        length: usize,
    },
    /// The path has bytes that iceoryx2 does not take.
    #[error("the path {path} can't be used as the root of a domain")]
    RootPath {
        /// The path.
        path: PathBuf,
    },
    /// A folder can't be used.
    #[error(transparent)]
    Folder(#[from] FolderError),
    /// `XDG_RUNTIME_DIR` would mean another folder to each process.
    #[error("XDG_RUNTIME_DIR is `{path}`; it must be an absolute path, the same for the daemon and its clients")]
    Relative {
        /// The path.
        path: PathBuf,
    },
}

/// A named meeting place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Domain {
    name: String,
    root: PathBuf,
    prefix: String,
}

impl Domain {
    /// The domain of this name, or of [`DOMAIN_VARIABLE`], or [`DEFAULT_DOMAIN`].
    ///
    /// # Errors
    /// [`DomainError::Name`], [`DomainError::Relative`] and [`DomainError::RootTooLong`].
    pub fn locate(name: Option<&str>) -> Result<Self, DomainError> {
        let variable = std::env::var(DOMAIN_VARIABLE).ok().filter(|name| !name.is_empty());
        let name = name.or(variable.as_deref()).unwrap_or(DEFAULT_DOMAIN);
        let runtime = std::env::var_os("XDG_RUNTIME_DIR").filter(|path| !path.is_empty());
        Self::new(name, runtime.as_deref().map(Path::new), rustix::process::getuid().as_raw())
    }

    /// The domain of this name for a user.
    ///
    /// # Errors
    /// [`DomainError::Name`], [`DomainError::Relative`] and [`DomainError::RootTooLong`].
    pub fn new(name: &str, runtime_folder: Option<&Path>, uid: u32) -> Result<Self, DomainError> {
        let good = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'-' || byte == b'_';
        if name.is_empty() || name.len() > MAX_NAME_BYTES || !name.bytes().all(good) {
            return Err(DomainError::Name { name: name.to_owned() });
        }
        let base = match runtime_folder {
            Some(folder) if folder.is_relative() => return Err(DomainError::Relative { path: folder.to_owned() }),
            Some(folder) => folder.join(FOLDER_NAME),
            None => folder_without_variable(uid),
        };
        let root = base.join(name);
        let length = root.as_os_str().len();
        if length > MAX_ROOT_BYTES {
            return Err(DomainError::RootTooLong { path: root, length });
        }
        let prefix = format!("untangled-{uid}-{:08x}-", fnv1a(root.as_os_str().as_encoded_bytes()));
        Ok(Self { name: name.to_owned(), root, prefix })
    }

    /// Its name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its root folder.
    #[must_use]
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// The prefix of its files in `/dev/shm`.
    #[must_use]
    pub fn prefix(&self) -> &str {
        &self.prefix
    }

    /// The folder of all domains.
    #[must_use]
    pub fn base(&self) -> &Path {
        self.root.parent().unwrap_or(&self.root)
    }

    /// The file that a daemon locks while it serves.
    #[must_use]
    pub fn lock_path(&self) -> PathBuf {
        self.root.with_extension("lock")
    }

    /// Whether a daemon has said that clients may come.
    #[must_use]
    pub fn is_announced(&self) -> bool {
        std::fs::symlink_metadata(self.lock_path()).is_ok_and(|metadata| metadata.is_file() && metadata.len() > 0)
    }

    /// Creates the folder of all domains where it is missing, and checks that it belongs to this user alone.
    ///
    /// # Errors
    /// [`DomainError::Folder`].
    pub fn create_base_folder(&self) -> Result<(), DomainError> {
        Ok(folders::create(self.base())?)
    }

    /// Creates the root folder where it is missing, and checks that it belongs to this user alone. For the daemon.
    ///
    /// # Errors
    /// [`DomainError::Folder`].
    pub fn create_folders(&self) -> Result<(), DomainError> {
        self.create_base_folder()?;
        Ok(folders::create(&self.root)?)
    }

    /// Checks that the root folder exists and belongs to this user alone.
    ///
    /// # Errors
    /// [`DomainError::Folder`].
    pub fn check_folders(&self) -> Result<(), DomainError> {
        folders::check(self.base())?;
        folders::check(&self.root)?;
        Ok(())
    }

    /// The configuration of iceoryx2 for this domain. It reads no configuration file.
    ///
    /// # Errors
    /// [`DomainError::RootPath`].
    pub fn config(&self) -> Result<Config, DomainError> {
        let refused = || DomainError::RootPath { path: self.root.clone() };
        let root = iceoryx2::prelude::Path::new(self.root.as_os_str().as_encoded_bytes()).map_err(|_| refused())?;
        let mut config = Config::default();
        config.global.set_root_path(&root);
        // Only the daemon cleans up dead nodes: cleanup may take longer than a client's deadline, and a client that is
        // killed during a cleanup leaves files that nothing removes.
        config.global.node.cleanup_dead_nodes_on_creation = false;
        config.global.node.cleanup_dead_nodes_on_destruction = false;
        config.global.service.cleanup_dead_nodes_on_open = false;
        config.global.prefix = FileName::new(self.prefix.as_bytes()).map_err(|_| refused())?;
        Ok(config)
    }
}

/// The folder of all domains where `XDG_RUNTIME_DIR` is not set.
pub(crate) fn folder_without_variable(uid: u32) -> PathBuf {
    PathBuf::from(format!("/tmp/untangled-{uid}"))
}

/// The 32-bit FNV-1a hash: short, and easy to write in any language.
fn fnv1a(bytes: &[u8]) -> u32 {
    bytes.iter().fold(0x811c_9dc5, |hash, &byte| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193))
}

#[cfg(test)]
mod tests {
    use std::{
        fs::Permissions,
        os::unix::fs::{MetadataExt, PermissionsExt},
    };

    use super::*;

    #[test]
    fn create_folders_repairs_mode_of_existing_folder() {
        let base = std::env::temp_dir().join(format!("umask-{}", std::process::id()));
        let domain = Domain::new("test", Some(&base), rustix::process::getuid().as_raw()).unwrap();
        domain.create_folders().unwrap();
        std::fs::set_permissions(domain.root(), Permissions::from_mode(0o600)).unwrap();
        domain.create_folders().unwrap();
        let mode = std::fs::metadata(domain.root()).unwrap().mode() & 0o777;
        std::fs::remove_dir_all(&base).unwrap();
        assert_eq!(mode, 0o700);
    }

    #[test]
    fn new_derives_paths_and_rejects_bad_names_and_long_roots() {
        let domain = Domain::new("test", Some(Path::new("/run/user/7")), 7).unwrap();
        assert_eq!(domain.root(), Path::new("/run/user/7/untangled/test"));
        assert_eq!(domain.lock_path(), Path::new("/run/user/7/untangled/test.lock"));
        assert!(domain.prefix().starts_with("untangled-7-"));
        let other = Domain::new("test", None, 7).unwrap();
        assert_eq!(other.root(), Path::new("/tmp/untangled-7/test"));
        assert_ne!(domain.prefix(), other.prefix());
        for name in ["", "a/b", "..", "a b", &"x".repeat(25)] {
            assert!(matches!(Domain::new(name, None, 7), Err(DomainError::Name { .. })), "{name}");
        }
        let long = Path::new("/a/very/long/runtime/folder/that/nobody/would/ever/choose");
        assert!(matches!(Domain::new("test", Some(long), 7), Err(DomainError::RootTooLong { .. })));
        assert!(matches!(Domain::new("test", Some(Path::new("run")), 7), Err(DomainError::Relative { .. })));
        assert_eq!(fnv1a(b"a"), 0xe40c_292c);
    }
}
