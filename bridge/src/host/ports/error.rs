//! Why a message was not handed to the host.

use crate::wire::elements::ElementsError;

/// Why a message was not handed to the host.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum DeliverError {
    /// Lengths contradict each other or what was registered, or the session has no such service.
    Malformed,
    /// The set of pins that a correction builds on has not come.
    PinsMissing,
    /// The transport failed, or shared memory is full.
    Transport(String),
}

impl DeliverError {
    pub(super) fn transport(reason: &impl std::fmt::Debug) -> Self {
        Self::Transport(format!("{reason:?}"))
    }
}

impl From<ElementsError> for DeliverError {
    fn from(error: ElementsError) -> Self {
        match error {
            ElementsError::Malformed => Self::Malformed,
            ElementsError::PinsMissing => Self::PinsMissing,
        }
    }
}
