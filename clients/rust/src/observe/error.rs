//! Why a session can't be watched, or not any more.

use thiserror::Error;

use crate::error::{ConnectError, RequestError};

/// Why a session can't be watched, or not any more.
#[derive(Debug, Error)]
pub enum ObserveError {
    /// There is no daemon, or another version of one.
    #[error(transparent)]
    Connect(#[from] ConnectError),
    /// The daemon refused, in particular since there is no such session, or could not be asked.
    #[error(transparent)]
    Request(#[from] RequestError),
    /// The daemon does not know observers.
    #[error("the untangled daemon of domain `{domain}` is too old to let its sessions be watched; update it")]
    TooOld {
        /// The domain.
        domain: String,
    },
    /// As many as may watch it do so already.
    #[error("session {session} is watched by {most} observers already, and by no more at a time")]
    TooMany {
        /// The session.
        session: u64,
        /// How many there may be.
        most: usize,
    },
    /// The session has ended.
    #[error("session {session} of domain `{domain}` has ended")]
    SessionEnded {
        /// The session.
        session: u64,
        /// The domain.
        domain: String,
    },
    /// The daemon has ended or was killed, and its sessions with it.
    #[error("the untangled daemon of domain `{domain}` went away, and session {session} with it")]
    DaemonGone {
        /// The session.
        session: u64,
        /// The domain.
        domain: String,
    },
    /// What came can't be what the daemon meant.
    #[error("what came of session {session} does not fit together: {what}")]
    Malformed {
        /// The session.
        session: u64,
        /// What does not fit.
        what: String,
    },
}

impl ObserveError {
    /// Whether a session that was watched is gone: [`reopen`](super::Observer::reopen) finds the one that its host
    /// registers after a restart of the daemon.
    #[must_use]
    pub fn is_end(&self) -> bool {
        matches!(self, Self::SessionEnded { .. } | Self::DaemonGone { .. })
    }
}
