//! The lock of a domain: one daemon at a time, and cleanup of a domain that no process uses.
//!
//! A daemon holds the lock while it serves. The last process that leaves a domain, daemon or client, takes it for a
//! moment and wipes the files that iceoryx2 does not remove: a few management files, and all resources of crashed
//! peers.

use std::{
    fs::{File, OpenOptions},
    io::{Error, ErrorKind, Read, Result, Seek, Write},
    os::unix::fs::{MetadataExt, OpenOptionsExt},
    path::{Path, PathBuf},
    time::Duration,
};

use rustix::{
    fs::{FlockOperation, OFlags, flock},
    io::Errno,
};

use crate::{Domain, DomainError, memory, node};

/// Why a domain's lock was not taken.
#[derive(Debug, thiserror::Error)]
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
    /// Takes the lock as a server does: a client that is just leaving may hold it for a moment, so waits for up to a
    /// fifth of a second.
    ///
    /// # Errors
    /// [`LockError`].
    pub fn acquire_patiently(domain: &'a Domain) -> std::result::Result<Self, LockError> {
        const ATTEMPTS: u32 = 10;
        for _ in 1..ATTEMPTS {
            match Self::acquire(domain) {
                Err(LockError::Held { .. }) => std::thread::sleep(Duration::from_millis(20)),
                other => return other,
            }
        }
        Self::acquire(domain)
    }

    /// Takes the lock; an error names the process that holds it. Does not wait.
    ///
    /// # Errors
    /// [`LockError`].
    pub fn acquire(domain: &'a Domain) -> std::result::Result<Self, LockError> {
        domain.create_base_folder()?;
        let path = domain.lock_path();
        let failed = |source| LockError::File { path: path.clone(), source };
        loop {
            let mut file = open(&path).map_err(failed)?;
            match flock(&file, FlockOperation::NonBlockingLockExclusive) {
                Ok(()) => {}
                Err(Errno::WOULDBLOCK) => {
                    let pid = pid(&mut file).ok().flatten();
                    return Err(LockError::Held { domain: domain.name().to_owned(), pid });
                }
                Err(error) => return Err(failed(error.into())),
            }
            if is_at(&file, &path).map_err(failed)? {
                pid(&mut file).map_err(failed)?;
                file.set_len(0).map_err(failed)?;
                return Ok(Self { domain, file });
            }
            // Its holder has removed it meanwhile.
        }
    }

    /// Says that clients may come: writes the process id into the lock's file. Before that, and after
    /// [`withdraw`](Self::withdraw), the domain may be wiped under them.
    ///
    /// # Errors
    /// [`LockError::File`].
    pub fn announce(&mut self) -> std::result::Result<(), LockError> {
        let written = self.file.rewind().and_then(|()| writeln!(self.file, "{}", std::process::id()));
        written.map_err(|source| LockError::File { path: self.domain.lock_path(), source })
    }

    /// Says that no more clients shall come.
    ///
    /// # Errors
    /// [`LockError::File`].
    pub fn withdraw(&mut self) -> std::result::Result<(), LockError> {
        self.file.set_len(0).map_err(|source| LockError::File { path: self.domain.lock_path(), source })
    }

    /// Gives the lock up and removes its file.
    ///
    /// # Errors
    /// [`LockError::File`].
    pub fn remove(self) -> std::result::Result<(), LockError> {
        let path = self.domain.lock_path();
        // While it is held: who opened the file before looks whether it is still there, once it has the lock.
        std::fs::remove_file(&path).map_err(|source| LockError::File { path, source })
    }

    /// Removes the root folder and all files of the domain in shared memory, if no live process uses the domain.
    ///
    /// # Errors
    /// [`LockError::File`] and [`LockError::Domain`].
    pub fn wipe_if_unused(&self) -> std::result::Result<(), LockError> {
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
        if self.0.root().exists() || self.0.lock_path().exists() {
            let _ = DomainLock::acquire(&self.0).and_then(|lock| {
                lock.wipe_if_unused()?;
                lock.remove()
            });
        }
    }
}

/// Opens the file of a lock, and creates it where it is missing. Changes nothing in it.
fn open(path: &Path) -> Result<File> {
    let flags = OFlags::NOFOLLOW.bits().cast_signed();
    let file = OpenOptions::new()
        .read(true)
        .write(true)
        .create(true)
        .truncate(false)
        .mode(0o600)
        .custom_flags(flags)
        .open(path)
        .map_err(|error| match Errno::from_io_error(&error) {
            Some(Errno::LOOP) => Error::other("this is a link, and no file of a daemon; remove it"),
            _ => error,
        })?;
    let metadata = file.metadata()?;
    if !metadata.is_file() || metadata.uid() != rustix::process::getuid().as_raw() {
        return Err(Error::other("this is no file of this user; remove it"));
    }
    Ok(file)
}

/// Whether an open file is the one at a path.
fn is_at(file: &File, path: &Path) -> Result<bool> {
    let own = file.metadata()?;
    match std::fs::symlink_metadata(path) {
        Ok(other) => Ok((own.dev(), own.ino()) == (other.dev(), other.ino())),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(false),
        Err(error) => Err(error),
    }
}

/// The process id in the file of a lock; nothing where it is empty. A file that holds anything else is none of a
/// daemon's, and must not be emptied.
fn pid(file: &mut File) -> Result<Option<u32>> {
    const LONGEST: u64 = 16;
    let mut bytes = Vec::new();
    file.rewind()?;
    file.take(LONGEST).read_to_end(&mut bytes)?;
    let text = String::from_utf8_lossy(&bytes);
    match text.trim() {
        "" => Ok(None),
        pid => pid.parse().map(Some).map_err(|_| Error::other("this is no file of a daemon; remove it")),
    }
}

#[cfg(test)]
mod tests {
    use std::{fs, os::unix::fs::symlink};

    use super::*;

    fn domain(name: &str) -> (Domain, PathBuf) {
        let runtime = std::env::temp_dir().join(format!("lock-{}-{name}", std::process::id()));
        fs::create_dir(&runtime).unwrap();
        (Domain::new("test", Some(&runtime), rustix::process::getuid().as_raw()).unwrap(), runtime)
    }

    #[test]
    fn acquire_of_a_link_or_another_file_is_refused_and_leaves_it_as_it_is() {
        let (domain, runtime) = domain("link");
        domain.create_base_folder().unwrap();
        let victim = runtime.join("victim");
        fs::write(&victim, "precious\n").unwrap();
        symlink(&victim, domain.lock_path()).unwrap();
        let link = DomainLock::acquire(&domain).map(drop).unwrap_err().to_string();
        fs::remove_file(domain.lock_path()).unwrap();
        fs::hard_link(&victim, domain.lock_path()).unwrap();
        let other = DomainLock::acquire(&domain).map(drop).unwrap_err().to_string();
        let kept = fs::read_to_string(&victim).unwrap();
        fs::remove_dir_all(&runtime).unwrap();
        assert!(link.contains("link") && link.contains("test.lock"), "{link}");
        assert!(other.contains("no file of a daemon"), "{other}");
        assert_eq!(kept, "precious\n");
    }

    /// Two users: this one is root, the other is nobody, who was here first.
    #[test]
    fn acquire_below_a_folder_of_another_user_is_refused() {
        if !rustix::process::getuid().is_root() {
            println!("skipped: only root can make a folder of another user");
            return;
        }
        let (domain, runtime) = domain("owner");
        let (base, victim) = (domain.base(), runtime.join("victim"));
        fs::write(&victim, "precious\n").unwrap();
        fs::create_dir(base).unwrap();
        symlink(&victim, domain.lock_path()).unwrap();
        std::os::unix::fs::chown(base, Some(65534), Some(65534)).unwrap();
        let folder = DomainLock::acquire(&domain).map(drop).unwrap_err().to_string();
        fs::remove_dir_all(base).unwrap();
        let theirs = runtime.join("theirs");
        fs::create_dir(&theirs).unwrap();
        symlink(&theirs, base).unwrap();
        let link = DomainLock::acquire(&domain).map(drop).unwrap_err().to_string();
        let (kept, made) = (fs::read_to_string(&victim).unwrap(), fs::read_dir(&theirs).unwrap().count());
        fs::remove_dir_all(&runtime).unwrap();
        assert!(folder.contains("belongs to user 65534"), "{folder}");
        assert!(link.contains("is a link"), "{link}");
        assert_eq!((kept.as_str(), made), ("precious\n", 0));
    }

    #[test]
    fn acquire_after_removal_of_the_file_takes_a_new_one() {
        let (domain, runtime) = domain("removed");
        let lock = DomainLock::acquire(&domain).unwrap();
        assert!(matches!(DomainLock::acquire(&domain), Err(LockError::Held { .. })));
        lock.remove().unwrap();
        let is_gone = !domain.lock_path().exists();
        let again = DomainLock::acquire(&domain).is_ok();
        fs::remove_dir_all(&runtime).unwrap();
        assert!(is_gone && again);
    }
}
