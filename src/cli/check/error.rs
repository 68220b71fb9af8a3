//! Why a check could not be done.

use std::{io, path::PathBuf};

use thiserror::Error;

use crate::cli::{fix::FixError, gap::GapError, input::InputError};

/// Why a check could not be done.
#[derive(Debug, Error)]
pub enum CheckError {
    /// The files can't be analysed.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The gap can't be checked.
    #[error(transparent)]
    Gap(#[from] GapError),
    /// `--contours` names neither OBJ nor PLY.
    #[error("{}: contours are written as .obj or .ply", .0.display())]
    ContoursFormat(PathBuf),
    /// `--contours` names an input.
    #[error("{}: is an input and would be overwritten by the contours", .0.display())]
    ContoursOverInput(PathBuf),
    /// `--contours` names a file that exists.
    #[error("{}: exists; --overwrite replaces it", .0.display())]
    ContoursExist(PathBuf),
    /// `--contours` names a file that may not be written.
    #[error("{}: is write-protected, and --overwrite does not replace such files", .0.display())]
    ContoursProtected(PathBuf),
    /// The page can't be written.
    #[error(transparent)]
    Page(#[from] Box<FixError>),
    /// An output can't be written.
    #[error("{}: can't be written: {source}", path.display())]
    Write {
        /// The file, or `standard output`.
        path: PathBuf,
        /// What is wrong.
        source: io::Error,
    },
}
