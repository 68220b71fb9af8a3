//! The fuzz targets, a fixed number of inputs each. More of them: `cargo run --release --example soak -- fuzz-ingest fuzz-register
//! fuzz-settings fuzz-mesh-file`, with `--seed` for other ones.

#![allow(
    dead_code,
    unreachable_pub,
    clippy::unwrap_used,
    clippy::cast_possible_truncation,
    reason = "shared with a program for developers, whose numbers are small"
)]

#[path = "../examples/soak/fuzz.rs"]
mod fuzz;

use fuzz::{Target, run};

/// Some inputs must get through, or the target shows nothing.
fn assert_no_find(target: Target, count: u64) {
    match run(target, 7, 0, count) {
        Ok(num_accepted) => assert!(num_accepted > count / 20, "only {num_accepted} of {count} inputs were accepted"),
        Err(find) => panic!("{find}"),
    }
}

#[test]
fn ingest() {
    assert_no_find(Target::Ingest, 4_000);
}

#[test]
fn register() {
    assert_no_find(Target::Register, 1_000);
}

#[test]
fn settings() {
    assert_no_find(Target::Settings, 1_000);
}

#[test]
fn mesh_files() {
    assert_no_find(Target::MeshFile, 4_000);
}
