//! Errors: one type for each operation of a host.

use std::{fmt, time::Duration};

use thiserror::Error;
use untangled_proto::{Precision, Status, limits};
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
    #[error("the untangled daemon of domain `{domain}` did not answer within {}", InWords(*waited))]
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
    #[error("{what} failed: {reason}")]
    Transport {
        /// What was tried.
        what: &'static str,
        /// What iceoryx2 or the system said.
        reason: String,
    },
}

impl RequestError {
    pub(crate) fn no_daemon(domain: &Domain) -> Self {
        Self::NoDaemon { domain: domain.name().to_owned(), searched: search::explain(domain) }
    }

    /// An error of iceoryx2, which has names for its errors and no words.
    pub(crate) fn transport(what: &'static str, name: &impl fmt::Debug) -> Self {
        Self::Transport { what, reason: iceoryx2_says(name) }
    }

    /// An error with words of its own.
    pub(crate) fn in_words(what: &'static str, reason: &impl fmt::Display) -> Self {
        Self::Transport { what, reason: reason.to_string() }
    }

    /// A daemon that ignored what it does not know: what that is, and the name of what asks for it.
    pub(crate) fn too_old(what: &str, name: &str) -> Self {
        let message = format!("it is too old to know {what}; update it, or register without {name}");
        Self::Refused { status: Status::BadRequest, message }
    }

    /// Whether another attempt may succeed: daemons start, and places in services that dead nodes occupy become free.
    pub(crate) fn may_pass(&self) -> bool {
        matches!(self, Self::NoDaemon { .. } | Self::Transport { .. })
    }
}

/// The name of an error of iceoryx2, said to be one.
pub(crate) fn iceoryx2_says(name: &impl fmt::Debug) -> String {
    format!("iceoryx2 says {name:?}")
}

/// A length of time for a reader. Takes no memory, since a host may ask for the words of each late frame.
struct InWords(Duration);

impl fmt::Display for InWords {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0 < Duration::from_secs(1) {
            write!(f, "{} ms", self.0.as_millis())
        } else {
            write!(f, "{:.1} s", self.0.as_secs_f64())
        }
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
    /// Whether nothing is wrong with the frame: the daemon ended it at a limit of time or of intersections. Go on
    /// without help for this step, as after a [`WaitError::Timeout`].
    #[must_use]
    pub fn is_transient(&self) -> bool {
        matches!(self.status, Status::TooManyIntersections | Status::OutOfTime)
    }

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
                format!("vertex {vertex} (counted from 0) has coordinate {value}; it must be finite and at most 2^250")
            }
            (Status::BadHeader, _) => match self.header_field {
                Some("dt_s") => {
                    let [least, most] = [limits::MIN_DT_S, limits::MAX_DT_S];
                    format!("the step dt_s is {value}; it must be from {least:e} to {most:e} seconds")
                }
                Some("simulated_s") => format!("the time simulated_s is {value}; it must be finite"),
                _ => format!("it has {value} positions; there must be as many as registered"),
            },
            (Status::Internal, _) => "a defect of the daemon; its log says more, and the session goes on".to_owned(),
            (status, _) => status.words().to_owned(),
        }
    }
}

/// Why a repair did not come, or was not asked for.
#[derive(Clone, Debug, Error)]
pub enum RepairError {
    /// The session has no repairs.
    #[error("the session has no repairs: it was registered without them, or by a daemon that does not know them")]
    NotOffered,
    /// The state was not published.
    #[error(transparent)]
    Publish(#[from] PublishError),
    /// It did not come in time. It may still come: see [`Session::poll_repair`](crate::Session::poll_repair).
    #[error("no repair of frame {frame} within {}", InWords(*waited))]
    Timeout {
        /// The frame.
        frame: u64,
        /// How long was waited.
        waited: Duration,
    },
    /// The daemon went away. The next call registers the session again.
    #[error("the untangled daemon went away while the repair of frame {frame} was waited for")]
    DaemonLost {
        /// The frame.
        frame: u64,
    },
    /// The daemon went on to a newer frame.
    #[error("the repair of frame {frame} was overtaken by that of frame {newest}")]
    Overtaken {
        /// The frame.
        frame: u64,
        /// The newest frame with a repair.
        newest: u64,
    },
    /// The daemon could not use the frame.
    #[error(transparent)]
    Refused(#[from] FrameRefusal),
    /// The transport failed; most likely too many repairs are held.
    #[error("receiving a repair failed, most likely since too many are held: {reason}")]
    Receive {
        /// The error of iceoryx2.
        reason: String,
    },
}

/// Why a correction did not come.
#[derive(Clone, Debug, Error)]
pub enum WaitError {
    /// It did not come in time.
    #[error("no correction of frame {frame} within {}", InWords(*waited))]
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
    #[error("receiving a correction failed, most likely since too many are held: {reason}")]
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
    #[error("receiving a correction failed, most likely since too many are held: {reason}")]
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_have_words_for_readers_and_no_names_of_this_code() {
        let refusal = FrameRefusal {
            frame: 3,
            status: Status::BadPosition,
            fault_index: Some(7),
            fault_value: f64::NAN,
            header_field: None,
        };
        let header =
            |header_field| FrameRefusal { status: Status::BadHeader, fault_index: None, header_field, ..refusal };
        let refused = RequestError::Refused { status: Status::BadMesh, message: "face 3 has vertex 9".into() };
        let messages = [
            (refusal.to_string(), "vertex 7 (counted from 0) has coordinate NaN"),
            (header(Some("dt_s")).to_string(), "the step dt_s is NaN; it must be from 1e-9 to 1e9 seconds"),
            (header(Some("simulated_s")).to_string(), "the time simulated_s is NaN"),
            (header(None).to_string(), "NaN"),
            (FrameRefusal { status: Status::Internal, ..refusal }.to_string(), "defect"),
            (FrameRefusal { status: Status::OutOfTime, fault_value: 8e3, ..refusal }.to_string(), "8000 us"),
            (refused.to_string(), "refused (bad mesh): face 3"),
            (WaitError::Timeout { frame: 3, waited: Duration::from_micros(50_123) }.to_string(), "within 50 ms"),
            (WaitError::Timeout { frame: 3, waited: Duration::from_millis(1500) }.to_string(), "within 1.5 s"),
            (PublishError::Precision { registered: Precision::F64 }.to_string(), "in double precision"),
        ];
        for (message, part) in messages {
            assert!(message.contains(part), "`{part}` is not in `{message}`");
            for internal in ["Some(", "None", "Bad", "F64", "F32", "::"] {
                assert!(!message.contains(internal), "{message}");
            }
        }
    }
}
