//! The configuration: a file, and flags over it.

mod explain;
mod model;

pub use explain::print;
pub use model::{Config, Limits, LogFormat, Telemetry};
