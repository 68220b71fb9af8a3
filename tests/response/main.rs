//! Corrections and relaxation, from the outside.
#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

mod allocations;
mod budget;
mod fineness;
mod harmless;
mod momenta;
mod numerics;
mod relax;
mod same_bytes;
mod shells;
