//! Every promise of `docs/results/numerics.md`, at sizes that a test has time for.

use untangled_testkit::numerics::{Case, Effort, chapters, single};

/// All promises of a chapter hold; those that don't are named, all of them.
fn check(title: &str) {
    let chapters = chapters();
    let chapter = chapters.iter().find(|chapter| chapter.title == title).unwrap();
    let broken = |case: &Case| Some(format!("{}: {}", case.what, case.measure(Effort::Quick).err()?));
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
fn promises_for_scale_and_place_hold() {
    check("Scale and place");
}

#[test]
fn promises_for_aspect_ratios_and_denormals_hold() {
    check("Aspect ratios and denormals");
}

#[test]
fn promises_for_contact_hold() {
    check("Contact");
}

#[test]
fn promises_for_centres_of_the_fits_hold() {
    check("Centres of the fits");
}

#[test]
fn promises_for_forces_masses_and_time_hold() {
    check("Forces, masses and time");
}

#[test]
fn promises_for_numbers_of_things_hold() {
    check("Numbers of things");
}

#[test]
fn promises_for_refusals_hold() {
    check("What is refused");
}

/// What the document says of a fit in single precision.
#[test]
fn fit_in_single_precision_is_near_until_centres_nearly_coincide() {
    let losses: Vec<_> = single::problems(100).iter().map(single::Problem::loss).collect();
    assert!(losses.iter().filter(|loss| loss.condition < 1e6).all(|loss| loss.all < 1e-2 && loss.images < 1e-2));
    assert!(losses.iter().any(|loss| loss.condition < 1e9 && loss.all > 0.1), "then it could be used after all");
}

#[test]
fn numerics_document_has_every_case_with_its_promise() {
    // The document wraps its text.
    let words = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    let document = words(include_str!("../../docs/results/numerics.md"));
    assert!(document.contains(&words(single::TEXT)));
    for chapter in chapters() {
        assert!(document.contains(chapter.title) && document.contains(&words(chapter.text)), "{}", chapter.title);
        for case in chapter.cases {
            let row = format!("| {} | {} | ", case.what, case.promise);
            assert!(document.contains(&words(&row)), "{row} is not in docs/results/numerics.md: make it again");
        }
    }
}
