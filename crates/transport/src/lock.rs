//! The lock of a domain: one daemon at a time, and nothing left behind.
//!
//! A daemon holds it while it serves. Whoever leaves a domain last, daemon or client, takes it for a moment and wipes what
//! iceoryx2 leaves: a few management files, and all that killed processes could not remove.

use std::{
    fs::{File, OpenOptions},
    io::{ErrorKind, Read, Seek, Write},
    os::unix::fs::OpenOptionsExt,
    path::{Path, PathBuf},
};

use iceoryx2::prelude::{CallbackProgression, Node, NodeState};
use rustix::fs::{FlockOperation, flock};
use thiserror::Error;

use crate::{Domain, DomainError, services::Ipc};

const SHARED_MEMORY: &str = "/dev/shm";

/// Why a domain's lock was not taken.
#[derive(Debug, Error)]
pub enum LockError {
    /// A daemon has it.
    #[error("another daemon{} serves domain `{domain}`", pid.map(|pid| format!(" (process {pid})")).unwrap_or_default())]
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
        /// What the system says.
        source: std::io::Error,
    },
}

/// The right to serve or to wipe a domain. The system takes it back when the process ends, however it does.
///
/// The control service has room for one server as well, but wiping must be excluded before there is any service.
#[derive(Debug)]
pub struct DomainLock<'a> {
    domain: &'a Domain,
    file: File,
}

impl<'a> DomainLock<'a> {
    /// Takes the right, or says who has it. Does not wait.
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

    /// Removes what dead processes left in the root folder and in shared memory, if no process uses the domain.
    ///
    /// # Errors
    /// [`LockError::File`] and [`LockError::Domain`].
    pub fn wipe_if_unused(&self) -> Result<(), LockError> {
        let mut used = false;
        let listed = Node::<Ipc>::list(&self.domain.config()?, |node| {
            used |= !matches!(node, NodeState::Dead(_));
            if used { CallbackProgression::Stop } else { CallbackProgression::Continue }
        });
        // What can't be listed may be in use.
        if used || listed.is_err() {
            return Ok(());
        }
        let failed = |path: &Path| {
            let path = path.to_owned();
            move |source| LockError::File { path, source }
        };
        // Moved away first: somebody who comes too early then can't write into what is being removed.
        let root = self.domain.root();
        let old = root.with_extension("old");
        let _ = std::fs::remove_dir_all(&old);
        match std::fs::rename(root, &old) {
            Err(error) if error.kind() == ErrorKind::NotFound => {}
            Err(error) => return Err(failed(root)(error)),
            // What is left of it goes with the next wipe.
            Ok(()) => drop(std::fs::remove_dir_all(&old)),
        }
        let folder = Path::new(SHARED_MEMORY);
        for entry in std::fs::read_dir(folder).map_err(failed(folder))?.flatten() {
            if entry.file_name().as_encoded_bytes().starts_with(self.domain.prefix().as_bytes()) {
                // Whoever else removes it meanwhile is welcome.
                let _ = std::fs::remove_file(entry.path());
            }
        }
        Ok(())
    }
}

/// Wipes the domain on the way out, if nobody else is left. Nothing that fails here matters to whoever leaves.
#[derive(Debug)]
pub struct WipeOnLeave(pub Domain);

impl Drop for WipeOnLeave {
    fn drop(&mut self) {
        if self.0.root().exists() {
            let _ = DomainLock::acquire(&self.0).and_then(|lock| lock.wipe_if_unused());
        }
    }
}
