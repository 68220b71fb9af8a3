//! Why a daemon does not serve, and why it refuses a request.

use std::fmt::Display;

use thiserror::Error;
use untangled_mesh_io::Printable;
use untangled_proto::Status;
use untangled_transport::{DomainError, lock::LockError};

/// Why a daemon did not start, or ended.
#[derive(Debug, Error)]
pub enum ServeError {
    /// There is a daemon already, or the domain's files can't be used.
    #[error(transparent)]
    Lock(#[from] LockError),
    /// The domain can't be used.
    #[error(transparent)]
    Domain(#[from] DomainError),
    /// A thread could not be started, or an address not be listened on.
    #[error("{what}: {source}")]
    System {
        /// What was tried.
        what: String,
        /// What the system says.
        source: std::io::Error,
    },
    /// The transport failed.
    #[error("{what} failed: iceoryx2 reports {reason}")]
    Transport {
        /// What was tried.
        what: &'static str,
        /// What iceoryx2 says.
        reason: String,
    },
    /// There is no shared memory left.
    #[error("{what} failed: /dev/shm is full")]
    NoRoom {
        /// What was tried.
        what: &'static str,
    },
}

impl ServeError {
    pub(crate) fn transport(what: &'static str, reason: &impl std::fmt::Debug) -> Self {
        Self::Transport { what, reason: format!("{reason:?}") }
    }
}

/// A request that is refused: a code for programs, a message for people.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{message}")]
pub struct Refusal {
    /// The code.
    pub status: Status,
    /// The reason in words, with the element and the value at fault.
    pub message: String,
}

impl Refusal {
    /// A refusal: one line that a log and a terminal may show. A message of more than 1000 bytes, which can only repeat
    /// what a peer sent, is cut.
    pub(crate) fn new(status: Status, message: impl Display) -> Self {
        const LONGEST: usize = 1000;
        let mut message = Printable(message).to_string();
        if message.len() > LONGEST {
            // Never in the middle of a character.
            let end = (0..=LONGEST).rev().find(|&end| message.is_char_boundary(end)).unwrap_or(0);
            message.truncate(end);
            message.push_str(" ...");
        }
        Self { status, message }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refusal_is_one_line_that_a_terminal_may_show_and_is_not_longer_than_a_reply_has_room_for() {
        let refusal = Refusal::new(Status::BadSettings, "there is no setting `\u{1b}[2J\n`");
        assert_eq!(refusal.message, "there is no setting `\\u{1b}[2J\\n`");
        let refusal = Refusal::new(Status::BadSettings, "\u{7}".repeat(1 << 20));
        assert!(refusal.message.starts_with("\\u{7}\\u{7}") && refusal.message.len() <= 1004, "{}", refusal.message);
    }
}
