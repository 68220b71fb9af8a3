//! The same bytes on every machine: digests of all answers for a dozen generated inputs, as `digests.tsv` has them.
//!
//! A change of an algorithm changes them: `cargo run --release -p untangled-lab --bin digests -- --generated` prints
//! the new ones. A machine, a build or a choice of instructions that changes them has found a fault.

use rayon::ThreadPoolBuilder;
use untangle::simd::use_portable_instructions;
use untangled_testkit::judge::digest::{Session, lines, worlds};

const STORED: &str = include_str!("digests.tsv");

/// Compares the lines of all worlds in one way of computing them.
fn assert_stored(way: &str, num_threads: usize, session: Session) {
    let pool = ThreadPoolBuilder::new().num_threads(num_threads).build().unwrap();
    let found: Vec<String> = pool.install(|| worlds().iter().flat_map(|world| lines(world, session)).collect());
    let stored: Vec<&str> = STORED.lines().collect();
    let differ: Vec<String> = found
        .iter()
        .zip(&stored)
        .filter(|(found, stored)| found != *stored)
        .map(|(found, stored)| format!("{found}\n  stored: {stored}"))
        .collect();
    assert!(differ.is_empty(), "{way}: {} lines differ:\n{}", differ.len(), differ.join("\n"));
    assert_eq!(found.len(), stored.len(), "{way}");
}

#[test]
fn digests_with_one_thread_are_those_stored() {
    assert_stored("one thread", 1, Session::Fresh);
}

#[test]
fn digests_of_used_sessions_with_five_threads_are_those_stored() {
    assert_stored("five threads, used sessions", 5, Session::Used);
}

#[test]
fn digests_with_portable_instructions_are_those_stored() {
    // Of the whole process: other tests of it go on with the same instructions for a while, to the same bytes.
    use_portable_instructions(true);
    assert_stored("portable instructions, three threads", 3, Session::Fresh);
    use_portable_instructions(false);
}
