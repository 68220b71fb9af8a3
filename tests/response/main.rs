//! Corrections and relaxation, from the outside.
#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

mod allocations;
mod budget;
mod fineness;
mod harmless;
mod instruction_sets;
mod momenta;
mod numerics;
mod relax;
mod shells;
