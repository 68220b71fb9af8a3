//! What the measurements share. Each program is in `src/bin`, and its results are in `docs/results`.

#![allow(clippy::print_stdout, reason = "measurements print tables")]

pub mod clock;
pub mod daemon;
pub mod gallery;
pub mod host;
pub mod names;
pub mod simulated_shot;
pub mod states;
pub mod table;

/// A failure that may cross threads.
pub type Failure = Box<dyn std::error::Error + Send + Sync>;
