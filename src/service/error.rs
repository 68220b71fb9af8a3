//! Why a daemon does not serve, and why it refuses a request.

use thiserror::Error;
use untangled_proto::{DomainError, Status, lock::LockError};

/// Why a daemon did not start, or ended.
#[derive(Debug, Error)]
pub enum ServeError {
    /// There is a daemon already, or the domain's files can't be used.
    #[error(transparent)]
    Lock(#[from] LockError),
    /// The domain can't be used.
    #[error(transparent)]
    Domain(#[from] DomainError),
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
