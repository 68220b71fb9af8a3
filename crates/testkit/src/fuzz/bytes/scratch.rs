//! A folder in memory for the files of one thread.

use std::path::{Path, PathBuf};

/// The folder, removed with its thread.
struct Folder(PathBuf);

impl Folder {
    fn new() -> Self {
        let name = format!("untangled-fuzz-{}-{:?}", std::process::id(), std::thread::current().id());
        let folder = Path::new("/dev/shm").join(name);
        std::fs::create_dir_all(&folder).expect("there is room for a folder");
        Self(folder)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

thread_local! {
    static FOLDER: Folder = Folder::new();
}

/// The path of a file of this thread, in a folder with nothing else in it.
pub(in crate::fuzz) fn path(name: &str) -> PathBuf {
    FOLDER.with(|folder| folder.0.join(name))
}

/// Writes a file of this thread, and gives its path.
pub(in crate::fuzz) fn write(name: &str, bytes: &[u8]) -> PathBuf {
    let path = path(name);
    std::fs::write(&path, bytes).expect("there is room for a small file");
    path
}
