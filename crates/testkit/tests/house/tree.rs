//! The files of the project.

use std::{
    fs,
    path::{Path, PathBuf},
};

/// Folders that are made, or are not ours.
const LEFT_OUT: [&str; 6] = ["target", "node_modules", "__pycache__", "book", ".git", ".pytest_cache"];

/// The folder of the workspace.
pub(crate) fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap()
}

/// All files below the root, by their path from there, sorted.
pub(crate) fn files() -> Vec<PathBuf> {
    let root = root();
    let mut files = Vec::new();
    let mut folders = vec![root.clone()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap().map(Result::unwrap) {
            let is_left_out = LEFT_OUT.iter().any(|name| entry.file_name() == *name);
            match entry.file_type().unwrap() {
                kind if kind.is_dir() && !is_left_out => folders.push(entry.path()),
                kind if kind.is_file() => files.push(entry.path().strip_prefix(&root).unwrap().to_owned()),
                _ => {}
            }
        }
    }
    files.sort();
    files
}
