//! The connection to a daemon, and requests on it.

mod connection;
mod memory;
mod poll;
mod request;

pub(crate) use connection::{Connection, RETRY};
pub(crate) use memory::{check_memory, commit_memory};
pub(crate) use poll::{Backoff, SLICE, deadline_in};
pub(crate) use request::{Pending, Reply};
