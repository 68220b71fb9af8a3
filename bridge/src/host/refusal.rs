//! A request that the host end refuses: a code for programs, a message for people, as a daemon does.

use untangled_proto::Status;

/// Why a request is refused.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Refusal {
    pub(crate) status: Status,
    pub(crate) message: String,
}

impl Refusal {
    pub(crate) fn new(status: Status, message: impl ToString) -> Self {
        Self { status, message: message.to_string() }
    }

    /// A defect here, or of the transport.
    pub(crate) fn failed(what: &str, reason: &dyn std::fmt::Debug) -> Self {
        Self::new(Status::Internal, format_args!("{what} failed: iceoryx2 reports {reason:?}"))
    }
}
