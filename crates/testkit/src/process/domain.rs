//! Domains for tests.

use std::{
    os::unix::fs::MetadataExt,
    path::PathBuf,
    sync::atomic::{AtomicU32, Ordering},
};

use untangled_client::{Client, ClientOptions};
use untangled_transport::{Domain, memory};

use super::PATIENCE;

/// A domain that no other test uses. Dropping it removes its files, after its daemon and its clients have ended.
#[derive(Debug)]
pub struct TestDomain(pub Domain);

impl Default for TestDomain {
    fn default() -> Self {
        Self::new()
    }
}

impl TestDomain {
    /// Chooses a name that no other process and no other test of this process has; makes no file.
    pub fn new() -> Self {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let name = format!("test-{}-{}", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
        Self(Domain::locate(Some(&name)).unwrap())
    }

    /// Its name.
    pub fn name(&self) -> &str {
        self.0.name()
    }

    /// A client of its daemon, which must run.
    pub fn connect(&self) -> Client {
        Client::connect(self.options()).unwrap()
    }

    /// Options of a client of this domain that waits up to [`PATIENCE`].
    pub fn options(&self) -> ClientOptions {
        ClientOptions { domain: Some(self.name().to_owned()), timeout: PATIENCE }
    }

    /// Names of the domain's files in shared memory.
    pub fn shared_memory(&self) -> Vec<String> {
        let names = std::fs::read_dir(memory::FOLDER).unwrap().map(|entry| entry.unwrap().file_name());
        names.filter_map(|name| name.into_string().ok()).filter(|name| name.starts_with(self.0.prefix())).collect()
    }

    /// Bytes of shared memory that the domain has taken.
    pub fn shared_bytes(&self) -> u64 {
        let files = self.shared_memory().into_iter().map(|name| PathBuf::from(memory::FOLDER).join(name));
        // A file that is removed meanwhile takes none.
        files.filter_map(|path| std::fs::metadata(path).ok()).map(|file| 512 * file.blocks()).sum()
    }

    /// Everything but folders below the domain's root.
    pub fn files(&self) -> Vec<PathBuf> {
        let mut folders = vec![self.0.root().to_owned()];
        let mut files = Vec::new();
        while let Some(folder) = folders.pop() {
            for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
                if entry.file_type().is_ok_and(|kind| kind.is_dir()) {
                    folders.push(entry.path());
                } else {
                    files.push(entry.path());
                }
            }
        }
        files
    }

    /// Asserts that neither shared memory nor files of the domain are left.
    #[track_caller]
    pub fn assert_nothing_left(&self) {
        assert_eq!(self.shared_memory(), Vec::<String>::new());
        assert_eq!(self.files(), Vec::<PathBuf>::new());
    }
}

impl Drop for TestDomain {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(self.0.root());
        let _ = std::fs::remove_file(self.0.lock_path());
        for name in self.shared_memory() {
            let _ = std::fs::remove_file(PathBuf::from(memory::FOLDER).join(name));
        }
    }
}
