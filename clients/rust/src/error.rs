//! Errors: one type for each operation of a host.

use std::time::Duration;

use thiserror::Error;
use untangled_proto::{Precision, Status};
use untangled_transport::{Domain, DomainError, search};

/// Why a request to the daemon failed.
#[derive(Clone, Debug, Error)]
pub enum RequestError {
    /// No daemon serves the domain.
    #[error("no untangled daemon serves domain `{domain}` {searched}")]
    NoDaemon {
        /// The domain.
        domain: String,
        /// Where it was looked for, and where else daemons of this user serve, in words.
        searched: String,
    },
    /// The daemon did not answer in time.
    #[error("the untangled daemon of domain `{domain}` did not answer within {waited:?}")]
    Timeout {
        /// The domain.
        domain: String,
        /// How long was waited.
        waited: Duration,
    },
    /// The daemon refused.
    #[error("the untangled daemon refused ({}): {message}", status.words())]
    Refused {
        /// The reason as a code.
        status: Status,
        /// The reason in words, with the element and the value at fault.
        message: String,
    },
    /// Shared memory is too full for the samples.
    #[error("shared memory has {free} bytes free, {needed} are needed")]
    NotEnoughMemory {
        /// Bytes needed.
        needed: u64,
        /// Bytes free.
        free: u64,
    },
    /// The transport failed.
    #[error("{what} failed: iceoryx2 reports {reason}")]
    Transport {
        /// What was tried.
        what: &'static str,
        /// The error of iceoryx2.
        reason: String,
    },
}

impl RequestError {
    pub(crate) fn no_daemon(domain: &Domain) -> Self {
        Self::NoDaemon { domain: domain.name().to_owned(), searched: search::explain(domain) }
    }

    pub(crate) fn transport(what: &'static str, reason: &impl std::fmt::Debug) -> Self {
        Self::Transport { what, reason: format!("{reason:?}") }
    }

    /// Whether another attempt may succeed: daemons start, and places in services that dead nodes occupy become free.
    pub(crate) fn may_pass(&self) -> bool {
        matches!(self, Self::NoDaemon { .. } | Self::Transport { .. })
    }
}

/// Why a client could not connect.
#[derive(Debug, Error)]
pub enum ConnectError {
    /// The domain can't be used.
    #[error(transparent)]
    Domain(#[from] DomainError),
    /// The daemon runs another version of iceoryx2 or of the protocol.
    #[error("the untangled daemon of domain `{domain}` and this client don't fit together: {reason}")]
    Version {
        /// The domain.
        domain: String,
        /// Which versions.
        reason: String,
    },
    /// The handshake failed.
    #[error(transparent)]
    Request(#[from] RequestError),
}

impl ConnectError {
    /// Whether trying again may help.
    pub(crate) fn may_pass(&self) -> bool {
        match self {
            Self::Domain(_) => true,
            Self::Version { .. } => false,
            Self::Request(error) => error.may_pass(),
        }
    }
}

/// Why a session could not be opened.
#[derive(Clone, Debug, Error)]
pub enum RegisterError {
    /// The daemon refused, or could not be asked.
    #[error(transparent)]
    Request(#[from] RequestError),
}

/// Why a state was not published.
#[derive(Clone, Debug, Error)]
pub enum PublishError {
    /// The daemon went away, and has not yet taken the session up again. Try again with the next frame.
    #[error("the untangled daemon went away; the session waits to be registered again")]
    Reconnecting,
    /// The session can't be registered again.
    #[error(transparent)]
    Request(#[from] RequestError),
    /// The session was registered with the other precision.
    #[error("the session was registered with positions in {} precision", precision_in_words(*registered))]
    Precision {
        /// The session's precision.
        registered: Precision,
    },
}

/// A frame that the daemon could not use, or did not finish. The session lives on.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[error("frame {frame} was {}", self.in_words())]
pub struct FrameRefusal {
    /// The frame.
    pub frame: u64,
    /// Why.
    pub status: Status,
    /// The vertex at fault, if one is.
    pub fault_index: Option<u64>,
    /// The value at fault.
    pub fault_value: f64,
    /// The field of the header at fault, if one is: `dt_s`, `simulated_s` or `num_vertices`.
    pub header_field: Option<&'static str>,
}

fn precision_in_words(precision: Precision) -> &'static str {
    match precision {
        Precision::F32 => "single",
        Precision::F64 => "double",
    }
}

impl FrameRefusal {
    /// What happened to the frame, and why.
    fn in_words(&self) -> String {
        let value = self.fault_value;
        match self.status {
            Status::TooManyIntersections => {
                format!("not analysed: more faces intersect than the limit allows, {value} pairs")
            }
            Status::OutOfTime => {
                format!("not analysed: its {value} us were up before its intersections were found")
            }
            _ => format!("refused: {}", self.fault_in_words()),
        }
    }

    /// What is wrong with the frame.
    fn fault_in_words(&self) -> String {
        let value = self.fault_value;
        match (self.status, self.fault_index) {
            (Status::BadPosition, Some(vertex)) => {
                format!(
                    "vertex {vertex} (counted from 0) has coordinate {value}; coordinates must be finite and at most \
                     2^250"
                )
            }
            (Status::BadHeader, _) => match self.header_field {
                Some("dt_s") => format!("the step dt_s is {value}; it must be from 1e-9 to 1e9 s"),
                Some("simulated_s") => format!("the time simulated_s is {value}; it must be finite"),
                _ => format!("it has {value} positions; there must be as many as registered"),
            },
            (Status::Internal, _) => "a defect of the daemon; its log says more, and the session goes on".to_owned(),
            (status, _) => status.words().to_owned(),
        }
    }
}

/// Why a correction did not come.
#[derive(Clone, Debug, Error)]
pub enum WaitError {
    /// It did not come in time.
    #[error("no correction of frame {frame} within {waited:?}")]
    Timeout {
        /// The frame.
        frame: u64,
        /// How long was waited.
        waited: Duration,
    },
    /// The daemon went away. The next call registers the session again.
    #[error("the untangled daemon went away while frame {frame} was waited for")]
    DaemonLost {
        /// The frame.
        frame: u64,
    },
    /// The daemon went on to a newer frame.
    #[error("frame {frame} was overtaken by frame {newest}")]
    Overtaken {
        /// The frame.
        frame: u64,
        /// The newest frame with a correction.
        newest: u64,
    },
    /// The daemon could not use the frame.
    #[error(transparent)]
    Refused(#[from] FrameRefusal),
    /// The transport failed; most likely too many corrections are held.
    #[error("receiving a correction failed, most likely since too many are held: iceoryx2 reports {reason}")]
    Receive {
        /// The error of iceoryx2.
        reason: String,
    },
}

/// Why there is no newest correction.
#[derive(Clone, Debug, Error)]
pub enum NewestError {
    /// The daemon could not use the frame.
    #[error(transparent)]
    Refused(#[from] FrameRefusal),
    /// The transport failed; most likely too many corrections are held.
    #[error("receiving a correction failed, most likely since too many are held: iceoryx2 reports {reason}")]
    Receive {
        /// The error of iceoryx2.
        reason: String,
    },
}

/// Why an exchange failed.
#[derive(Clone, Debug, Error)]
pub enum ExchangeError {
    /// The state was not published.
    #[error(transparent)]
    Publish(#[from] PublishError),
    /// The correction did not come.
    #[error(transparent)]
    Wait(#[from] WaitError),
}
