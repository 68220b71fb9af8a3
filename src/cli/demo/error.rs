//! Why the demonstration could not be given.

use std::{io, path::PathBuf, process::ExitStatus};

use thiserror::Error;
use untangled_publisher::obj::ObjError;

use untangle::{frame::FrameError, mesh::MeshError};

/// Why the demonstration could not be given.
#[derive(Debug, Error)]
pub enum DemoError {
    /// A file or a process failed.
    #[error("{what}: {source}")]
    System {
        /// What was tried.
        what: String,
        /// What the system said.
        source: io::Error,
    },
    /// The publisher ended with an error, which it printed itself.
    #[error("the publisher failed ({0})")]
    Publisher(ExitStatus),
    /// The daemon ended before it was asked to.
    #[error("the daemon ended ({status}): {log}")]
    Daemon {
        /// How it ended.
        status: ExitStatus,
        /// The last line of its log.
        log: String,
    },
    /// The publisher's summary can't be read.
    #[error("the publisher's summary: {0}")]
    Summary(#[from] serde_json::Error),
    /// A mesh can't be read.
    #[error(transparent)]
    Obj(#[from] ObjError),
    /// A mesh is not valid.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// A state is not valid.
    #[error(transparent)]
    Frame(#[from] FrameError),
    /// A picture can't be written.
    #[error("writing {path}: {source}")]
    Picture {
        /// The picture.
        path: PathBuf,
        /// What the encoder said.
        source: png::EncodingError,
    },
}

impl DemoError {
    pub(super) fn system(what: impl Into<String>) -> impl FnOnce(io::Error) -> Self {
        let what = what.into();
        move |source| Self::System { what, source }
    }
}
