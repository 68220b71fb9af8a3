//! What `check` and `fix` say of other readers: those of single precision, and those that split polygons otherwise.

use std::fs;

use untangled_testkit::files::shared;

use crate::mesh_folder::{code, command, fix, json};

/// A spike whose tip is a third of a last place of single precision above a floor: clean, but not once it is rounded.
const NEAR: &str = "v 0 0 1\nv 4 0 1\nv 0 4 1.0000001\nv 1 1 1.00000003\nv 1 1.5 3\nv 1.5 1 3\nf 1 2 3\nf 4 5 6\n";
/// A quad bent along one diagonal, and a spike that only the other diagonal meets.
const BENT: &str = "v 0 0 1\nv 1 0 0\nv 1 1 1\nv 0 1 0\nv 0.5 0.45 0.5\nv 0.6 0.5 -3\nv 0.5 0.6 -3\n\
                    f 1 2 3 4\nf 5 6 7\n";

#[test]
fn fix_of_a_cloth_that_only_rounding_tangles_separates_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("near.obj"), NEAR).unwrap();
    let output = command("check", path).args(["near.obj", "--json"]).output().unwrap();
    let report = json(&output);
    assert_eq!((code(&output), &report["num_face_pairs"]), (0, &0.into()));
    assert_eq!(report["certificate"]["num_crossings_single"], 1, "{report}");
    let report = json(&fix(&["near.obj", "-o", "out.obj", "--json"], path));
    assert_eq!(report["clean"], true, "{report}");
    assert_eq!(report["after"]["certificate"]["num_crossings_single"], 0);
}

#[test]
fn fix_of_a_quad_that_another_diagonal_tangles_is_clean_for_both() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("bent.obj"), BENT).unwrap();
    let output = command("check", path).args(["bent.obj", "--json"]).output().unwrap();
    let report = json(&output);
    assert_eq!((code(&output), &report["num_face_pairs"]), (0, &0.into()), "{report}");
    assert_eq!(report["certificate"]["num_polygon_pairs"], 1, "{report}");
    let text = command("check", path).arg("bent.obj").output().unwrap();
    assert!(
        String::from_utf8_lossy(&text.stdout).contains("polygons split along any diagonals: 1 crossing polygon pair")
    );
    let report = json(&fix(&["bent.obj", "-o", "out.obj", "--json"], path));
    assert_eq!((&report["clean"], &report["after"]["certificate"]["num_polygon_pairs"]), (&true.into(), &0.into()));
    assert!(fs::read_to_string(path.join("out.obj")).unwrap().contains("f 1 2 3 4\n"));
}

#[test]
fn fix_of_quads_of_the_cases_is_clean_for_most_readers() {
    let Some(made) = shared("cases/made") else { return };
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out.obj");
    let report = json(&command("check", &made).args(["quads_other_diagonal.obj", "--json"]).output().unwrap());
    assert_eq!(report["num_face_pairs"], 0);
    assert!(report["certificate"]["num_crossings_first_corner"].as_u64().unwrap() > 0, "{report}");
    let report = json(&fix(&["quads_other_diagonal.obj", "-o", out.to_str().unwrap(), "--json"], &made));
    assert_eq!(report["clean"], true, "{report}");
}
