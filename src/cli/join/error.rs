//! Why parts were not joined.

use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::cli::fix::FixError;

/// Why parts were not joined.
#[derive(Debug, Error)]
pub(super) enum JoinError {
    /// A part can't be read, or is none.
    #[error("{}: {reason}", path.display())]
    Part {
        /// The part.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// The output can't be written.
    #[error(transparent)]
    Target(#[from] FixError),
}

impl JoinError {
    /// The error of one part.
    pub(super) fn of(path: &Path, reason: impl ToString) -> Self {
        Self::Part { path: path.to_path_buf(), reason: reason.to_string() }
    }
}
