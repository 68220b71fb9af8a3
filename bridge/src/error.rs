//! Why an end of a bridge does not start, or ended.

use std::path::PathBuf;

use thiserror::Error;
use untangled_client::{ConnectError, RequestError};
use untangled_transport::{DomainError, lock::LockError};

/// Why an end of a bridge does not start, or ended.
#[derive(Debug, Error)]
pub enum BridgeError {
    /// The configuration can't be read, or says something that can't be.
    #[error("{0}")]
    Config(String),
    /// A file of the configuration can't be read.
    #[error("{path}: {source}")]
    File {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// The local domain is taken, or can't be used.
    #[error(transparent)]
    Lock(#[from] LockError),
    /// The local domain can't be used.
    #[error(transparent)]
    Domain(#[from] DomainError),
    /// The local daemon can't be reached.
    #[error(transparent)]
    Connect(#[from] ConnectError),
    /// The local daemon can't be asked, or shared memory is full.
    #[error(transparent)]
    Request(#[from] RequestError),
    /// The network can't be used.
    #[error("{what}: Zenoh reports {reason}")]
    Network {
        /// What was tried.
        what: String,
        /// What Zenoh says.
        reason: String,
    },
    /// Shared memory can't be used.
    #[error("{what} failed: iceoryx2 reports {reason}")]
    Transport {
        /// What was tried.
        what: &'static str,
        /// What iceoryx2 says.
        reason: String,
    },
    /// A thread could not be started, or an address not be listened on.
    #[error("{what}: {source}")]
    System {
        /// What was tried.
        what: String,
        /// What the system says.
        source: std::io::Error,
    },
}

impl BridgeError {
    pub(crate) fn network(what: impl Into<String>, reason: &impl std::fmt::Display) -> Self {
        Self::Network { what: what.into(), reason: reason.to_string() }
    }

    pub(crate) fn transport(what: &'static str, reason: &impl std::fmt::Debug) -> Self {
        Self::Transport { what, reason: format!("{reason:?}") }
    }
}
