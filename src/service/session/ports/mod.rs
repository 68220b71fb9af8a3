//! The daemon's ports of a session, each with the service that it belongs to.

mod corrections;
mod dense;
mod finish;
mod labels;
mod sparse;
mod states;

pub(crate) use corrections::CorrectionPort;
pub(crate) use states::StatePort;
