//! What the tests, benchmarks and measurements of untangled share.
//!
//! | module | what |
//! |---|---|
//! | [`generate`] | meshes and positions: sheets, folds, fans, every degenerate kind |
//! | [`judge`] | what an answer is held against: brute force, rational numbers, rules, digests, summaries |
//! | [`files`] | one mesh in each format, numpy archives, the shared folder beside the checkout |
//! | [`process`] | daemons and clients as processes, each on a domain of its own |
//! | [`hosts`] | programs in other languages: compilers, Python, the same frames for all clients |
//! | [`faults`] | rows of the fault table: what is killed, filled up or lied to, and what the others lose by it |
//! | [`fuzz`] | seeded random inputs for everything that reads bytes from outside |
//! | [`numerics`] | extreme inputs with what is promised for each |
//!
//! Everything panics where it cannot go on: a caller is a test or a measurement.

#![allow(
    clippy::unwrap_used,
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    clippy::cast_sign_loss,
    clippy::float_cmp,
    clippy::print_stdout,
    reason = "code of tests: what goes wrong fails one, its numbers are small, and its child processes speak on \
              standard output"
)]

pub mod generate;

pub mod judge;

pub mod files;

pub mod shots;

pub mod process;

pub mod hosts;

pub mod faults;

pub mod intake;

pub mod fuzz;

#[cfg(feature = "numerics")]
pub mod numerics;
