//! The host end's ports of a session: those that a daemon would have.

mod corrections;
mod down;
mod error;
mod paths;
mod publication;
mod repairs;
mod shape;
mod states;

pub(crate) use down::DownPorts;
pub(crate) use error::DeliverError;
pub(crate) use shape::Shape;
pub(crate) use states::StatePort;
