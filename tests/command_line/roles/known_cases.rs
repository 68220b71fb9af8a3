//! Bodies and garments of `../shared`.

use std::fs;

use untangled_testkit::files::shared;

use super::{check, fix_and_judge};

/// Copies files of `../shared/cases` into a folder, and fixes a cloth beside bodies there.
fn fix_known(folder: &str, cloth: &str, bodies: &[&str]) {
    let here = tempfile::tempdir().unwrap();
    for name in bodies.iter().copied().chain([cloth]) {
        let Some(path) = shared(&format!("cases/{folder}/{name}.obj")) else { return };
        fs::write(here.path().join(format!("{name}.obj")), fs::read(path).unwrap()).unwrap();
    }
    let files: Vec<String> = bodies.iter().map(|name| format!("{name}.obj")).collect();
    let bodies: Vec<&str> = files.iter().map(String::as_str).collect();
    fix_and_judge(&format!("{cloth}.obj"), &bodies, here.path());
}

#[test]
fn fix_of_belts_and_sleeves_beside_their_bodies_ends_clean_and_outside() {
    for radius in ["1000", "1005", "1010", "1015", "1020", "1025", "1030", "1035", "mostly_inside", "open"] {
        fix_known("made", &format!("belt_{radius}"), &["ball"]);
    }
    for slant in ["6", "10"] {
        fix_known("made", &format!("sleeve_{slant}"), &["arm"]);
    }
}

#[test]
fn fix_beside_a_body_that_overlaps_itself_ends_clean_and_outside() {
    fix_known("made", "belt_mostly_outside", &["body_overlapping_itself", "ball"]);
}

#[test]
fn fix_of_suits_on_their_body_ends_clean_and_outside() {
    for suit in ["male_casualsuit02", "male_elegantsuit01", "female_elegantsuit01"] {
        fix_known("makehuman", suit, &["body"]);
    }
}

#[test]
fn check_of_a_suit_on_its_body_counts_pairs_of_the_two_only() {
    let (Some(body), Some(suit)) =
        (shared("cases/makehuman/body.obj"), shared("cases/makehuman/male_casualsuit02.obj"))
    else {
        return;
    };
    let [body, suit] = [&body, &suit].map(|path| path.to_str().unwrap());
    let (code, report) = check(&[suit, "--body", body], std::path::Path::new("."));
    assert_eq!((code, &report["num_face_pairs"]), (1, &report["num_body_face_pairs"]));
}
