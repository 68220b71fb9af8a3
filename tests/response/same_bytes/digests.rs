//! The same bytes on every machine: digests of all answers for a dozen generated inputs, as `digests.tsv` has them.
//!
//! A change of an algorithm changes them: `cargo run --release -p untangled-lab --bin digests -- --generated` prints
//! the new ones. A machine, a build or a choice of instructions that changes them has found a fault.

use rayon::{ThreadPoolBuilder, prelude::*};
use untangled_testkit::judge::digest::{Session, World, lines, worlds};

use super::{with_best, with_portable};

const STORED: &str = include_str!("digests.tsv");

/// The lines of all worlds, several of which are computed at a time, each with so many threads.
fn found(num_threads: usize, session: Session) -> Vec<String> {
    let lines_of = |world: &World| {
        let pool = ThreadPoolBuilder::new().num_threads(num_threads).build().unwrap();
        pool.install(|| lines(world, session))
    };
    worlds().par_iter().map(lines_of).collect::<Vec<_>>().concat()
}

/// Compares the lines of one way of computing them.
fn assert_stored(way: &str, found: &[String]) {
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
    assert_stored("one thread", &with_best(|| found(1, Session::Fresh)));
}

#[test]
fn digests_of_used_sessions_with_five_threads_are_those_stored() {
    assert_stored("five threads, used sessions", &with_best(|| found(5, Session::Used)));
}

#[test]
fn digests_with_portable_instructions_are_those_stored() {
    assert_stored("portable instructions, three threads", &with_portable(|| found(3, Session::Fresh)));
}
