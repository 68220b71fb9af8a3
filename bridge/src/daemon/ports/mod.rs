//! The daemon end's ports of a session: those that a client would have.

mod corrections;
mod paths;
mod repairs;
mod shape;
mod states;

pub(super) use corrections::CorrectionPort;
pub(super) use paths::PathsPort;
pub(super) use repairs::RepairPort;
pub(super) use shape::{Shape, listener};
pub(super) use states::{StateError, StatePort};
