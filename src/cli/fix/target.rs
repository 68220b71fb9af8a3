//! The place of an output: whether it may be written, and replacing it in one step.

use std::{
    fs::{self, File},
    io::{self, BufWriter, Write},
    os::unix::fs::PermissionsExt,
    path::{Path, PathBuf},
};

use tempfile::NamedTempFile;

use crate::cli::input::is_same_file;

use super::{error::FixError, terminal::Interrupt};

/// A file that may be written.
#[derive(Clone, Debug)]
pub(in crate::cli) struct Target {
    /// The path as the user named it.
    pub(in crate::cli) path: PathBuf,
    /// The path with links resolved, so that a link is kept and its file replaced.
    pub(in crate::cli) place: PathBuf,
    pub(in crate::cli) overwrite: bool,
}

impl Target {
    /// Checks that `path` may be written: it leads to no file of `inputs` through any spelling or link, and to an
    /// existing file only with `overwrite`; and that its folder takes files.
    ///
    /// # Errors
    /// [`FixError::Target`].
    pub(in crate::cli) fn new(path: PathBuf, inputs: &[&Path], overwrite: bool) -> Result<Self, FixError> {
        let error = |reason: String| FixError::Target { path: path.clone(), reason };
        if inputs.iter().any(|input| is_same_file(&path, input)) {
            return Err(error("is an input, and inputs are never overwritten".into()));
        }
        let place = match fs::symlink_metadata(&path) {
            Ok(_) => existing_place(&path, overwrite),
            Err(source) if source.kind() != io::ErrorKind::NotFound => Err(format!("can't be found: {source}")),
            Err(_) => new_place(&path),
        }
        .map_err(error)?;
        check_folder(&place).map_err(error)?;
        Ok(Self { path, place, overwrite })
    }

    /// Whether two targets are the same file.
    pub(in crate::cli) fn is_same_place(&self, other: &Self) -> bool {
        // Names that differ in case only are the same file on some systems; refusing them on the others costs little.
        let name = |target: &Self| target.place.to_string_lossy().to_lowercase();
        name(self) == name(other)
    }

    /// Writes a temporary file beside the place and synchronises it to the disk. It is removed when dropped, and by a
    /// signal.
    pub(in crate::cli) fn stage(
        &self,
        interrupt: &Interrupt,
        write: impl FnOnce(&mut dyn Write) -> Result<(), FixError>,
    ) -> Result<Staged, FixError> {
        let failed = |source: io::Error| self.failed(&source);
        let folder = self.place.parent().unwrap_or(Path::new("/"));
        let extension = self.place.extension().map_or_else(String::new, |name| format!(".{}", name.to_string_lossy()));
        let existing = fs::metadata(&self.place).ok().map(|metadata| metadata.permissions());
        let mut builder = tempfile::Builder::new();
        // The permissions of a new file, before the user's umask.
        builder.prefix(".untangled-").suffix(&extension).permissions(fs::Permissions::from_mode(0o666));
        let file = interrupt.stage(|| builder.tempfile_in(folder)).map_err(|source| failed(plain(&source)))?;
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
    pub(in crate::cli) fn failed(&self, source: &dyn std::fmt::Display) -> FixError {
        FixError::Target { path: self.path.clone(), reason: format!("can't be written: {source}") }
    }
}

/// Checks that a file can be made in the folder of a place, by making one without a name.
fn check_folder(place: &Path) -> Result<(), String> {
    let folder = place.parent().unwrap_or(Path::new("/"));
    match tempfile::tempfile_in(folder) {
        Ok(_) => Ok(()),
        Err(source) => Err(format!("no file can be made in its folder: {}", plain(&source))),
    }
}

/// An error of the system without the name of a temporary file, which means nothing to anybody.
fn plain(source: &io::Error) -> io::Error {
    source.raw_os_error().map_or_else(|| source.kind().into(), io::Error::from_raw_os_error)
}

/// The place of an existing file, if it may be replaced.
fn existing_place(path: &Path, overwrite: bool) -> Result<PathBuf, String> {
    let metadata = fs::metadata(path).map_err(|source| format!("is a link that leads nowhere: {source}"))?;
    if metadata.is_dir() {
        return Err("is a folder".into());
    }
    if !overwrite {
        return Err("exists; --overwrite replaces it".into());
    }
    if !metadata.is_file() {
        return Err("is not a regular file".into());
    }
    if metadata.permissions().readonly() {
        // A rename would replace it all the same, but whoever took away the right to write meant it.
        return Err("is write-protected, and --overwrite does not replace such files".into());
    }
    fs::canonicalize(path).map_err(|source| format!("can't be found: {source}"))
}

/// The place of a file that does not exist, in a folder that does.
fn new_place(path: &Path) -> Result<PathBuf, String> {
    let name = path.file_name().filter(|_| !has_trailing_slash(path)).ok_or("there is no such folder")?;
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let folder = fs::canonicalize(folder)
        .ok()
        .filter(|folder| folder.is_dir())
        .ok_or_else(|| format!("there is no folder {}", folder.display()))?;
    Ok(folder.join(name))
}

fn has_trailing_slash(path: &Path) -> bool {
    path.as_os_str().as_encoded_bytes().ends_with(b"/")
}

/// A complete temporary file beside its place.
#[derive(Debug)]
pub(in crate::cli) struct Staged {
    file: NamedTempFile,
    target: Target,
}

impl Staged {
    /// Its current path.
    pub(in crate::cli) fn path(&self) -> &Path {
        self.file.path()
    }

    /// Renames the file to its place, which is one step.
    pub(in crate::cli) fn persist(self) -> Result<(), FixError> {
        let Self { file, target } = self;
        // A file that was created since the check in `new` is not replaced without `overwrite`.
        let result = if target.overwrite { file.persist(&target.place) } else { file.persist_noclobber(&target.place) };
        result.map_err(|error| target.failed(&error.error))?;
        // The new name is on the disk only after its folder is synchronised. Not all file systems allow that, so errors
        // are ignored.
        let folder = target.place.parent().and_then(|folder| File::open(folder).ok());
        folder.map(|folder| folder.sync_all());
        Ok(())
    }
}
