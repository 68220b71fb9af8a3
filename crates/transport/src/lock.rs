//! The lock of a domain: one daemon at a time, and cleanup of a domain that no process uses.
//!
//! A daemon holds the lock while it serves. The last process that leaves a domain, daemon or client, takes it for a
//! moment and wipes the files that iceoryx2 does not remove: a few management files, and all resources of crashed
//! peers.

use std::{
    fs::{File, OpenOptions},
    io::{ErrorKind, Read, Seek, Write},
    os::unix::fs::OpenOptionsExt,
    path::{Path, PathBuf},
};

use rustix::fs::{FlockOperation, flock};
use thiserror::Error;

use crate::{Domain, DomainError, memory, node};

/// Why a domain's lock was not taken.
#[derive(Debug, Error)]
pub enum LockError {
    /// A daemon has it.
    #[error("another daemon{} serves domain `{domain}`", in_brackets(*pid))]
    Held {
        /// The domain.
        domain: String,
        /// The daemon's process, if known.
        pid: Option<u32>,
    },
    /// The domain can't be used.
    #[error(transparent)]
    Domain(#[from] DomainError),
    /// A file could not be used.
    #[error("{path}: {source}")]
    File {
        /// The file.
        path: PathBuf,
        /// The error of the system.
        source: std::io::Error,
    },
}

fn in_brackets(pid: Option<u32>) -> String {
    pid.map(|pid| format!(" (process {pid})")).unwrap_or_default()
}

/// The right to serve or to wipe a domain: an `flock`, which the system releases when the process ends in any way.
///
/// The control service has room for one server as well, but wiping must be excluded before there is any service.
#[derive(Debug)]
pub struct DomainLock<'a> {
    domain: &'a Domain,
    file: File,
}

impl<'a> DomainLock<'a> {
    /// Takes the lock; an error names the process that holds it. Does not wait.
    ///
    /// # Errors
    /// [`LockError`].
    pub fn acquire(domain: &'a Domain) -> Result<Self, LockError> {
        domain.create_base_folder()?;
        let path = domain.lock_path();
        let failed = |source| LockError::File { path: path.clone(), source };
        let mut file = OpenOptions::new()
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
            .mode(0o600)
            .open(&path)
            .map_err(failed)?;
        match flock(&file, FlockOperation::NonBlockingLockExclusive) {
            Ok(()) => {}
            Err(rustix::io::Errno::WOULDBLOCK) => {
                let mut text = String::new();
                let pid = file.read_to_string(&mut text).ok().and_then(|_| text.trim().parse().ok());
                return Err(LockError::Held { domain: domain.name().to_owned(), pid });
            }
            Err(error) => return Err(failed(error.into())),
        }
        file.set_len(0).map_err(failed)?;
        Ok(Self { domain, file })
    }

    /// Says that clients may come: writes the process id into the lock's file. Before that, and after
    /// [`withdraw`](Self::withdraw), the domain may be wiped under them.
    ///
    /// # Errors
    /// [`LockError::File`].
    pub fn announce(&mut self) -> Result<(), LockError> {
        let written = self.file.rewind().and_then(|()| writeln!(self.file, "{}", std::process::id()));
        written.map_err(|source| LockError::File { path: self.domain.lock_path(), source })
    }

    /// Says that no more clients shall come.
    ///
    /// # Errors
    /// [`LockError::File`].
    pub fn withdraw(&mut self) -> Result<(), LockError> {
        self.file.set_len(0).map_err(|source| LockError::File { path: self.domain.lock_path(), source })
    }

    /// Removes the root folder and all files of the domain in shared memory, if no live process uses the domain.
    ///
    /// # Errors
    /// [`LockError::File`] and [`LockError::Domain`].
    pub fn wipe_if_unused(&self) -> Result<(), LockError> {
        // A domain whose nodes can't be listed may be in use.
        if node::living(&self.domain.config()?).map_or(true, |ids| !ids.is_empty()) {
            return Ok(());
        }
        let failed = |path: &Path| {
            let path = path.to_owned();
            move |source| LockError::File { path, source }
        };
        // Renamed first, so that a process that comes too early can't write into a folder that is being removed.
        let root = self.domain.root();
        let old = root.with_extension("old");
        let _ = std::fs::remove_dir_all(&old);
        match std::fs::rename(root, &old) {
            Err(error) if error.kind() == ErrorKind::NotFound => {}
            Err(error) => return Err(failed(root)(error)),
            // The next wipe removes files that could not be removed now.
            Ok(()) => drop(std::fs::remove_dir_all(&old)),
        }
        let folder = Path::new(memory::FOLDER);
        for entry in std::fs::read_dir(folder).map_err(failed(folder))?.flatten() {
            if entry.file_name().as_encoded_bytes().starts_with(self.domain.prefix().as_bytes()) {
                // Another process may have removed it meanwhile.
                let _ = std::fs::remove_file(entry.path());
            }
        }
        Ok(())
    }
}

/// Wipes the domain when it is dropped, if no other process uses the domain. Errors are ignored: the next process that
/// leaves or the next daemon tries again.
#[derive(Debug)]
pub struct WipeOnLeave(pub Domain);

impl Drop for WipeOnLeave {
    fn drop(&mut self) {
        if self.0.root().exists() {
            let _ = DomainLock::acquire(&self.0).and_then(|lock| lock.wipe_if_unused());
        }
    }
}
