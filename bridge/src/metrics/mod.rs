//! What an end counts: frames, bytes, drops, round trips.

mod counts;
mod histogram;
mod server;

pub use counts::{Flow, Metrics, count};
pub use histogram::Histogram;
pub use server::{Report, Server};
