//! The connection to a daemon, and requests on it.

mod connection;
mod poll;
mod request;
mod room;

pub(crate) use connection::{Connection, RETRY};
pub(crate) use poll::{Backoff, SLICE};
pub(crate) use request::{Pending, Reply};
pub(crate) use room::{check_memory, commit_memory};
