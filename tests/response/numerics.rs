//! Input at the limits: every promise of `docs/NUMERICS.md`, at sizes that a test has time for.

#![allow(
    clippy::unwrap_used,
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    clippy::cast_sign_loss,
    clippy::float_cmp,
    reason = "a test, whose numbers are small or the ones that are meant"
)]

#[allow(dead_code, reason = "the program that makes the document uses the rest")]
mod cases;

#[path = "../support/mod.rs"]
mod support;

use cases::{Effort, chapters};

/// All promises of a chapter hold; those that don't are named, all of them.
fn check(title: &str) {
    let chapters = chapters();
    let chapter = chapters.iter().find(|chapter| chapter.title == title).unwrap();
    let broken = |case: &cases::Case| Some(format!("{}: {}", case.what, case.measure(Effort::Quick).err()?));
    let broken: Vec<String> = chapter.cases.iter().filter_map(broken).collect();
    assert!(
        broken.is_empty(),
        "{} of {} promises are broken:\n{}",
        broken.len(),
        chapter.cases.len(),
        broken.join("\n")
    );
}

#[test]
fn scale_and_place() {
    check("Scale and place");
}

#[test]
fn aspect_ratios_and_denormals() {
    check("Aspect ratios and denormals");
}

#[test]
fn contact() {
    check("Contact");
}

#[test]
fn centres_of_the_fits() {
    check("Centres of the fits");
}

#[test]
fn forces_masses_and_time() {
    check("Forces, masses and time");
}

#[test]
fn numbers_of_things() {
    check("Numbers of things");
}

#[test]
fn refusals() {
    check("What is refused");
}

/// What the document says of a fit in single precision.
#[test]
fn single_precision_in_a_fit_costs_little_until_centres_nearly_coincide() {
    let losses: Vec<_> = cases::single::problems(100).iter().map(cases::single::Problem::loss).collect();
    assert!(losses.iter().filter(|loss| loss.condition < 1e6).all(|loss| loss.all < 1e-2 && loss.images < 1e-2));
    assert!(losses.iter().any(|loss| loss.condition < 1e9 && loss.all > 0.1), "then it could be used after all");
}

#[test]
fn the_document_has_every_case_with_its_promise() {
    let document = include_str!("../../docs/NUMERICS.md");
    assert!(document.contains(cases::single::TEXT));
    for chapter in chapters() {
        assert!(document.contains(chapter.title) && document.contains(chapter.text), "{}", chapter.title);
        for case in chapter.cases {
            let row = format!("| {} | {} | ", case.what, case.promise);
            assert!(document.contains(&row), "{row} is not in docs/NUMERICS.md: make it anew");
        }
    }
}
