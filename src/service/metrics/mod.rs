//! Metrics of the daemon as Prometheus text over HTTP, on a thread of its own. Frames never wait for it.
//!
//! | file | what it does |
//! |---|---|
//! | `text` | the report as text |
//! | `connection` | one request and its answer |
//! | `server` | the thread: all connections side by side |

mod connection;
mod server;
mod text;

pub(crate) use server::MetricsServer;
