//! Both ends of a bridge as processes, a daemon, and clients: over loopback.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "tests")]
#![allow(clippy::cast_possible_truncation, clippy::cast_precision_loss, reason = "positions of test cloths")]

mod clients;
mod faults;
mod hostile;
mod operation;
mod same_answers;
mod security;
