//! Why a daemon does not serve, and why it refuses a request.

use std::path::PathBuf;

use thiserror::Error;
use untangled_proto::{DomainError, Status};

/// Why a daemon did not start, or ended.
#[derive(Debug, Error)]
pub enum ServeError {
    /// There is one already.
    #[error("another daemon{} serves domain `{domain}`", pid.map(|pid| format!(" (process {pid})")).unwrap_or_default())]
    AlreadyServed {
        /// The domain.
        domain: String,
        /// Its process, if known.
        pid: Option<u32>,
    },
    /// The domain can't be used.
    #[error(transparent)]
    Domain(#[from] DomainError),
    /// A file could not be used.
    #[error("{path}: {source}")]
    File {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// The transport failed.
    #[error("{what}: {reason}")]
    Transport {
        /// What was tried.
        what: &'static str,
        /// What iceoryx2 says.
        reason: String,
    },
}

impl ServeError {
    pub(super) fn transport(what: &'static str, reason: &impl std::fmt::Debug) -> Self {
        Self::Transport { what, reason: format!("{reason:?}") }
    }
}

/// A request that is refused: a code for programs, words for people.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{message}")]
pub(super) struct Refusal {
    pub(super) status: Status,
    pub(super) message: String,
}

impl Refusal {
    pub(super) fn new(status: Status, message: impl ToString) -> Self {
        Self { status, message: message.to_string() }
    }
}
