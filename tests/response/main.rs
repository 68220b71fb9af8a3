//! Corrections and relaxation, from the outside.
#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

mod allocations;
mod budget;
mod momenta;
mod numerics;
mod relax;
