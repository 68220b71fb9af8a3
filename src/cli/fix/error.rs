//! Why `untangled fix` wrote nothing.

use std::{io, path::PathBuf};

use thiserror::Error;

use untangle::relax::RelaxError;
use untangled_mesh_io::WriteError;

use crate::cli::{gap::GapError, input::InputError};

/// Why nothing was written.
#[derive(Debug, Error)]
pub enum FixError {
    /// The files can't be untangled.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The gap can't be checked.
    #[error(transparent)]
    Gap(#[from] GapError),
    /// The pin file can't be used.
    #[error("{}{}: {reason}", path.display(), line.map_or(String::new(), |line| format!(":{line}")))]
    Pins {
        /// The pin file.
        path: PathBuf,
        /// Line at fault, from 1.
        line: Option<usize>,
        /// What is wrong.
        reason: String,
    },
    /// A file can't be written.
    #[error("{}: {reason}", path.display())]
    Target {
        /// The file.
        path: PathBuf,
        /// Why not.
        reason: String,
    },
    /// Two outputs have the same path.
    #[error(
        "{}: would be written twice, from {} and from {}",
        path.display(), inputs[0].display(), inputs[1].display()
    )]
    Twice {
        /// The output.
        path: PathBuf,
        /// The first inputs of both.
        inputs: [PathBuf; 2],
    },
    /// Vertices that are not pinned can't have other positions in the output.
    #[error(
        "{}: vertices {first} to {last} can't be moved: {reason}; write .obj or .ply, or pin these vertices",
        path.display()
    )]
    Fixed {
        /// The output.
        path: PathBuf,
        /// First vertex, counted over all inputs from 0.
        first: usize,
        /// Last vertex.
        last: usize,
        /// Why.
        reason: String,
    },
    /// A frame can't hold what is to be written.
    #[error(transparent)]
    Store(WriteError),
    /// A written file can't be read back.
    #[error("what was written can't be read back: {0}")]
    ReadBack(InputError),
    /// The relaxation refused a state.
    #[error("the relaxation failed: {0}")]
    Relax(RelaxError),
    /// Ctrl-C or SIGTERM.
    #[error("interrupted; nothing was written")]
    Interrupted,
    /// Signal handlers can't be installed.
    #[error("listening for Ctrl-C: {0}")]
    Signals(io::Error),
    /// The report can't be printed.
    #[error("standard output: {0}")]
    Print(io::Error),
}
