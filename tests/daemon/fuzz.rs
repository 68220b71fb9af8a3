//! The fuzz targets, a fixed number of inputs each.
//!
//! More of them: `cargo run --release -p untangled-lab --bin soak -- fuzz-ingest fuzz-register fuzz-settings
//! fuzz-mesh-file fuzz-stage`, with `--seed` for other ones.

use untangled_testkit::fuzz::{Target, run};

/// Some inputs must get through, or the target shows nothing.
fn assert_no_find(target: Target, count: u64) {
    match run(target, 7, 0, count) {
        Ok(num_accepted) => assert!(num_accepted > count / 20, "only {num_accepted} of {count} inputs were accepted"),
        Err(find) => panic!("{find}"),
    }
}

#[test]
fn ingest_of_damaged_frames_never_panics() {
    assert_no_find(Target::Ingest, 4_000);
}

#[test]
fn register_of_damaged_requests_never_panics() {
    assert_no_find(Target::Register, 1_000);
}

#[test]
fn settings_of_damaged_documents_never_panic() {
    assert_no_find(Target::Settings, 1_000);
}

#[test]
fn reading_damaged_mesh_files_never_panics() {
    assert_no_find(Target::MeshFile, 4_000);
}

#[test]
fn reading_damaged_stages_never_panics() {
    assert_no_find(Target::Stage, 4_000);
}
