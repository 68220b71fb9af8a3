//! What coverage-guided fuzzing found, one test for each find, and the seeds that it begins with.
//!
//! More inputs: `fuzz/run TARGET SECONDS`.

use untangled_testkit::fuzz::bytes::TARGETS;

#[test]
fn seeds_of_all_targets_hold_the_invariants_and_most_are_accepted() {
    for target in TARGETS {
        let seeds = (target.seeds)();
        let num_accepted = seeds.iter().filter(|seed| (target.read)(seed)).count();
        assert!(2 * num_accepted > seeds.len(), "{}: {num_accepted} of {} are accepted", target.name, seeds.len());
    }
}
