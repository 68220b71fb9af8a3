//! What coverage-guided fuzzing found, one test for each find, and the seeds that it begins with.
//!
//! More inputs: `fuzz/run TARGET SECONDS`.

use untangled_testkit::fuzz::bytes::{TARGETS, read};

#[test]
fn seeds_of_all_targets_hold_the_invariants_and_many_are_accepted() {
    for target in TARGETS {
        let seeds = (target.seeds)();
        let num_accepted = seeds.iter().filter(|seed| (target.read)(seed)).count();
        assert!(3 * num_accepted > seeds.len(), "{}: {num_accepted} of {} are accepted", target.name, seeds.len());
    }
}

#[test]
fn refusal_of_a_stage_does_not_quote_a_long_word_at_length() {
    let word = "x\u{1}".repeat(2000);
    let prims = format!("def Xform \"{word}\" {{ }} def Xform \"{word}\" {{ }}");
    let time = format!("def Mesh \"world\" {{ point3f[] points.timeSamples = {{ {word}: [] }} }}");
    for text in [prims, time] {
        assert!(!read("usd", format!("#usda 1.0\n{text}\n").as_bytes()));
    }
}

#[test]
fn refusal_of_settings_escapes_what_acts_on_terminals() {
    for document in [r#"{"\u001b[2J": 1}"#, r#"{"quality": "\u001b[2J\n"}"#, r#"{"response": "\u009b31m"}"#] {
        assert!(!read("settings", document.as_bytes()));
    }
}
