//! Names of numbered files: one run of `#` stands for the number, filled with zeros to its length.

use std::{
    fs,
    path::{Path, PathBuf},
};

use super::error::CacheErrorKind;

/// A pattern such as `cloth_####.obj`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pattern {
    folder: PathBuf,
    prefix: String,
    suffix: String,
    num_digits: usize,
}

impl Pattern {
    /// Whether a path is meant as a pattern.
    #[must_use]
    pub fn is_meant_by(path: &Path) -> bool {
        path.to_string_lossy().contains('#')
    }

    /// Splits a pattern.
    ///
    /// # Errors
    /// [`CacheErrorKind::Pattern`] unless there is exactly one run of `#`, in the name of the file.
    pub fn new(path: &Path) -> Result<Self, CacheErrorKind> {
        let folder = path.parent().unwrap_or_else(|| Path::new("")).to_path_buf();
        if Self::is_meant_by(&folder) {
            return Err(CacheErrorKind::Pattern("# must stand in the name of the file, not in that of a folder"));
        }
        let name = path.file_name().and_then(|name| name.to_str());
        let name = name.ok_or(CacheErrorKind::Pattern("the name of a pattern must be text"))?;
        let start = name.find('#').ok_or(CacheErrorKind::Pattern("has no # for the number of a frame"))?;
        let (prefix, rest) = name.split_at(start);
        let suffix = rest.trim_start_matches('#');
        if suffix.contains('#') {
            return Err(CacheErrorKind::Pattern("has more than one run of #"));
        }
        let num_digits = rest.len() - suffix.len();
        Ok(Self { folder, prefix: prefix.to_owned(), suffix: suffix.to_owned(), num_digits })
    }

    /// The file of a frame.
    #[must_use]
    pub fn file(&self, frame: u64) -> PathBuf {
        let Self { folder, prefix, suffix, num_digits } = self;
        folder.join(format!("{prefix}{frame:0num_digits$}{suffix}"))
    }

    /// The pattern itself.
    #[must_use]
    pub fn path(&self) -> PathBuf {
        let Self { folder, prefix, suffix, num_digits } = self;
        folder.join(format!("{prefix}{}{suffix}", "#".repeat(*num_digits)))
    }

    /// The folder of the files.
    #[must_use]
    pub fn folder(&self) -> &Path {
        if self.folder.as_os_str().is_empty() { Path::new(".") } else { &self.folder }
    }

    /// The frames for which there is a file, ascending.
    ///
    /// # Errors
    /// [`CacheErrorKind::Io`] for a folder that can't be read.
    pub fn find(&self) -> Result<Vec<u64>, CacheErrorKind> {
        let mut frames = Vec::new();
        for entry in fs::read_dir(self.folder())? {
            let name = entry?.file_name();
            frames.extend(name.to_str().and_then(|name| self.number(name)));
        }
        frames.sort_unstable();
        Ok(frames)
    }

    /// The number in a name that fits. A number with more digits than the pattern has no zeros before it.
    fn number(&self, name: &str) -> Option<u64> {
        let digits = name.strip_prefix(self.prefix.as_str())?.strip_suffix(self.suffix.as_str())?;
        let is_number = !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit());
        let is_padded = digits.len() == self.num_digits || digits.len() > self.num_digits && !digits.starts_with('0');
        if is_number && is_padded { digits.parse().ok() } else { None }
    }
}
