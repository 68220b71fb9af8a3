//! Where files are written: what may stand there, and how a file comes there whole.

use std::{
    fs::{self, File},
    io::{self, BufWriter, Write},
    os::unix::fs::PermissionsExt,
    path::{Path, PathBuf},
};

use tempfile::NamedTempFile;

use super::FixError;
use crate::cli::input::is_same_file;

/// A file that may be written.
#[derive(Clone, Debug)]
pub(super) struct Target {
    /// As the user named it.
    pub(super) path: PathBuf,
    /// Where it is in the end: links are followed, so that they stay links.
    place: PathBuf,
    overwrite: bool,
}

impl Target {
    /// Checks that a file may be written to `path`: no file of `inputs`, however spelt or linked, and an existing file only with
    /// `overwrite`.
    pub(super) fn new(path: PathBuf, inputs: &[&Path], overwrite: bool) -> Result<Self, FixError> {
        let error = |reason: String| FixError::Target { path: path.clone(), reason };
        if inputs.iter().any(|input| is_same_file(&path, input)) {
            return Err(error("is an input, and inputs are never overwritten".into()));
        }
        let place = match fs::symlink_metadata(&path) {
            Ok(_) => {
                let metadata =
                    fs::metadata(&path).map_err(|source| error(format!("is a link that leads nowhere: {source}")))?;
                if metadata.is_dir() {
                    return Err(error("is a folder".into()));
                }
                if !overwrite {
                    return Err(error("exists; --overwrite replaces it".into()));
                }
                if !metadata.is_file() {
                    return Err(error("is not a regular file".into()));
                }
                fs::canonicalize(&path).map_err(|source| error(format!("can't be found: {source}")))?
            }
            Err(source) if source.kind() != io::ErrorKind::NotFound => {
                return Err(error(format!("can't be found: {source}")));
            }
            Err(_) => {
                let name = path.file_name().filter(|_| !has_trailing_slash(&path));
                let name = name.ok_or_else(|| error("there is no such folder".into()))?;
                let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
                let folder = fs::canonicalize(folder)
                    .ok()
                    .filter(|folder| folder.is_dir())
                    .ok_or_else(|| error(format!("there is no folder {}", folder.display())))?;
                folder.join(name)
            }
        };
        Ok(Self { path, place, overwrite })
    }

    /// Whether two names end in one file.
    pub(super) fn is_same_place(&self, other: &Self) -> bool {
        // Where the system tells upper from lower case it costs nothing to refuse such a pair.
        let name = |target: &Self| target.place.to_string_lossy().to_lowercase();
        name(self) == name(other)
    }

    /// Writes a temporary file beside the place and brings it to the disk. It goes away when dropped.
    pub(super) fn stage(&self, write: impl FnOnce(&mut dyn Write) -> Result<(), FixError>) -> Result<Staged, FixError> {
        let failed = |source: io::Error| self.failed(&source);
        let folder = self.place.parent().unwrap_or(Path::new("/"));
        let extension = self.place.extension().map_or_else(String::new, |name| format!(".{}", name.to_string_lossy()));
        let existing = fs::metadata(&self.place).ok().map(|metadata| metadata.permissions());
        let file = tempfile::Builder::new()
            .prefix(".untangled-")
            .suffix(&extension)
            // What a new file has, less what the user's mask takes away.
            .permissions(fs::Permissions::from_mode(0o666))
            .tempfile_in(folder)
            .map_err(failed)?;
        let mut out = BufWriter::new(file.as_file());
        write(&mut out)?;
        out.flush().map_err(failed)?;
        drop(out);
        if let Some(permissions) = existing {
            file.as_file().set_permissions(permissions).map_err(failed)?;
        }
        file.as_file().sync_all().map_err(failed)?;
        Ok(Staged { file, target: self.clone() })
    }

    /// The error of a file that can't be written.
    pub(super) fn failed(&self, source: &dyn std::fmt::Display) -> FixError {
        FixError::Target { path: self.path.clone(), reason: format!("can't be written: {source}") }
    }
}

fn has_trailing_slash(path: &Path) -> bool {
    path.as_os_str().as_encoded_bytes().ends_with(b"/")
}

/// A whole file beside its place.
#[derive(Debug)]
pub(super) struct Staged {
    file: NamedTempFile,
    target: Target,
}

impl Staged {
    /// Where it is now.
    pub(super) fn path(&self) -> &Path {
        self.file.path()
    }

    /// Puts it into its place, in one step.
    pub(super) fn persist(self) -> Result<(), FixError> {
        let Self { file, target } = self;
        // What came into being since the first check is not replaced either.
        let result = if target.overwrite { file.persist(&target.place) } else { file.persist_noclobber(&target.place) };
        result.map_err(|error| target.failed(&error.error))?;
        // The name is on the disk only with its folder. Not all file systems let a folder be synchronised, and then nothing more can be done.
        let folder = target.place.parent().and_then(|folder| File::open(folder).ok());
        folder.map(|folder| folder.sync_all());
        Ok(())
    }
}
