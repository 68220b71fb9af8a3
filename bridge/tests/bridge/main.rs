//! Both ends of a bridge as processes, a daemon, and clients: over loopback.
//!
//! Needs the daemon's program: `cargo build -p untangled` in the folder above, with any profile; or name another one by
//! the environment variable `BRIDGE_TEST_DAEMON`.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "tests")]

mod cloth;
mod ends;
mod faults;
mod operation;
mod same_answers;
