//! The daemon as a process, with clients that behave and others.
#![expect(clippy::unwrap_used, clippy::float_cmp, reason = "a test fails by panicking, and its zeros are exact")]

mod faults;
mod fuzz;
mod machine;
mod observers;
mod operating;
mod protocol_v1;
mod refusals;
mod repair;
mod restarts;
mod sessions;
mod sparse;
mod timing;
