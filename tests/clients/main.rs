//! Clients in other languages, and the programs of the guide, against a real daemon.
#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

mod c;
mod guides;
mod memory;
mod python;
mod repairs;
mod usd;
