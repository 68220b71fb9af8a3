//! The connection to a daemon, and requests on it, as they are on the wire: for programs that pass on what others ask
//! for. A host uses [`Client`](crate::Client).

mod connection;
mod poll;
mod request;
mod room;

pub use connection::Connection;
pub(crate) use connection::RETRY;
pub use poll::Backoff;
pub(crate) use poll::{SLICE, deadline_in};
pub use request::{Pending, RawReply};
pub(crate) use request::{Reply, ask};
pub use room::{check_memory, commit_memory};
