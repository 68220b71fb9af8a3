//! The daemon's side of a domain: one daemon at a time, and nothing left behind.

use std::{
    fs::{File, OpenOptions},
    io::{ErrorKind, Read, Seek, Write},
    os::unix::fs::OpenOptionsExt,
    path::Path,
};

use iceoryx2::prelude::{CallbackProgression, Node, NodeState};
use rustix::fs::{FlockOperation, flock};
use untangled_proto::{Domain, services::Ipc};

use super::error::ServeError;

const SHARED_MEMORY: &str = "/dev/shm";

/// The right to serve a domain. The system takes it back when the process ends, however it does.
///
/// The control service has room for one server as well, but wiping what a dead daemon left must be excluded before there is
/// any service.
#[derive(Debug)]
pub(super) struct DomainLock<'a> {
    domain: &'a Domain,
    _file: File,
}

impl<'a> DomainLock<'a> {
    /// Takes the right, or says who has it.
    pub(super) fn acquire(domain: &'a Domain) -> Result<Self, ServeError> {
        domain.create_folders()?;
        let path = domain.lock_path();
        let failed = |source| ServeError::File { path: path.clone(), source };
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
                return Err(ServeError::AlreadyServed { domain: domain.name().to_owned(), pid });
            }
            Err(error) => return Err(failed(error.into())),
        }
        file.set_len(0).and_then(|()| file.rewind()).map_err(failed)?;
        writeln!(file, "{}", std::process::id()).map_err(failed)?;
        Ok(Self { domain, _file: file })
    }

    /// Removes what dead processes left in the root folder and in shared memory, if no process uses the domain.
    pub(super) fn wipe_if_unused(&self) -> Result<(), ServeError> {
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
            move |source| ServeError::File { path, source }
        };
        let root = self.domain.root();
        match std::fs::remove_dir_all(root) {
            Err(error) if error.kind() != ErrorKind::NotFound => return Err(failed(root)(error)),
            _ => {}
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
