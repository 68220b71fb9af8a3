//! What tests and measurements of the bridge share.
//!
//! Needs the daemon's program: `cargo build -p untangled` in the folder above, with any profile; or name another one by
//! the environment variable `BRIDGE_TEST_DAEMON`.

#![allow(clippy::unwrap_used, reason = "tests and measurements, which fail by panicking")]
#![allow(clippy::missing_panics_doc, reason = "as above")]
#![allow(clippy::cast_possible_truncation, clippy::cast_precision_loss, reason = "positions of test cloths, and times")]

pub mod certificates;
pub mod cloth;
pub mod ends;
pub mod network;
pub mod proxy;
pub mod times;
