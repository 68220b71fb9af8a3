//! Generated bodies and cloth.

use std::fs;

use untangled_testkit::generate::Sheet;

use super::{check, fix_and_judge, write};
use crate::mesh_folder::{code, complaint, fix, json};

fn ball(centres: &[[f64; 3]], rings: u32) -> Sheet {
    let mut sheet = Sheet::default();
    centres.iter().for_each(|&centre| sheet.add_ball(centre, 1.0, rings));
    sheet
}

/// A belt round a ball of radius 1, shifted to one side.
fn belt(radius: f64, shift: f64, around: u32) -> Sheet {
    let mut sheet = Sheet::default();
    sheet.add_tube(radius, [-0.25, 0.25], [around, around / 12], |_, _| [shift, 0.01, 0.02]);
    sheet
}

#[test]
fn check_with_body_counts_what_cloth_and_body_have_with_each_other_apart() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write(path, "body.obj", &ball(&[[0.0; 3], [0.0, 0.0, 1.2]], 16));
    write(path, "belt.obj", &belt(1.01, 0.04, 48));
    write(path, "inner.obj", &belt(0.8, 0.0, 48));
    let (code, report) = check(&["belt.obj", "--body", "body.obj"], path);
    assert_eq!(code, 1);
    // What is said of the mesh is said of the cloth.
    assert_eq!((&report["num_vertices"], &report["num_faces"]), (&240.into(), &384.into()));
    assert!(report["num_body_face_pairs"].as_u64() > Some(10));
    assert_eq!(report["num_face_pairs"], report["num_body_face_pairs"]);
    assert!((20..200).contains(&report["num_vertices_inside_body"].as_u64().unwrap()));
    assert_eq!(report["bodies"][0]["file"], "body.obj");
    assert!(report["bodies"][0]["num_own_face_pairs"].as_u64() > Some(10));
    // A cloth that is wholly inside intersects nothing, and is not clean.
    let (code, report) = check(&["inner.obj", "--body", "body.obj"], path);
    assert_eq!((code, &report["num_face_pairs"]), (1, &0.into()));
    assert_eq!(report["num_vertices_inside_body"], 240);
    let (code, report) = check(&["inner.obj"], path);
    assert_eq!((code, &report["bodies"], &report["num_body_face_pairs"]), (0, &().into(), &().into()));
}

#[test]
fn fix_of_belts_through_and_inside_of_a_ball_ends_outside_at_each_fineness() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write(path, "ball.obj", &ball(&[[0.0; 3]], 24));
    for around in [36, 60] {
        for (name, radius, shift) in [("through.obj", 1.01, 0.04), ("mostly.obj", 0.96, 0.08), ("inside.obj", 0.8, 0.0)]
        {
            write(path, name, &belt(radius, shift, around));
            let report = fix_and_judge(name, &["ball.obj"], path);
            let counts = |at: &str, name: &str| report[at][name].as_u64().unwrap();
            assert_eq!(counts("after", "num_body_face_pairs") + counts("after", "num_vertices_inside_body"), 0);
            assert!(counts("before", "num_vertices_inside_body") > 0);
        }
    }
}

#[test]
fn fix_of_a_sleeve_through_a_capsule_ends_outside_at_each_fineness() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let mut arm = Sheet::default();
    arm.add_capsule(0.3, 1.0, 30, 24);
    write(path, "arm.obj", &arm);
    for around in [24, 40] {
        let mut sleeve = Sheet::default();
        sleeve.add_tube(0.33, [-0.8, 0.7], [around, around], |_, height| [0.1 * (3.0 * height).sin(), 0.03, 0.0]);
        write(path, "sleeve.obj", &sleeve);
        fix_and_judge("sleeve.obj", &["arm.obj"], path);
    }
}

#[test]
fn fix_beside_bodies_that_overlap_ends_outside_of_all_of_them() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    // The faces of the second body point inwards.
    let mut second = ball(&[[0.0, 0.0, 1.2]], 16);
    second.faces.iter_mut().for_each(|face| face.swap(0, 1));
    write(path, "first.obj", &ball(&[[0.0; 3], [0.0, 0.3, 0.1]], 16));
    write(path, "second.obj", &second);
    write(path, "belt.obj", &belt(1.02, 0.04, 48));
    let report = fix_and_judge("belt.obj", &["first.obj", "second.obj"], path);
    assert!(report["bodies"][0]["num_own_face_pairs"].as_u64() > Some(10));
    assert_eq!(report["bodies"][1]["num_own_face_pairs"], 0);
}

#[test]
fn fix_of_a_cloth_outside_of_its_body_writes_it_unchanged() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write(path, "ball.obj", &ball(&[[0.0; 3], [0.5, 0.0, 0.0]], 12));
    write(path, "belt.obj", &belt(2.5, 0.0, 24));
    let report = fix_and_judge("belt.obj", &["ball.obj"], path);
    assert_eq!(report["num_iterations"], 0);
    assert_eq!(fs::read(path.join("out.obj")).unwrap(), fs::read(path.join("belt.obj")).unwrap());
}

#[test]
fn fix_with_pins_counts_them_over_the_cloth_only() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write(path, "ball.obj", &ball(&[[0.0; 3]], 12));
    write(path, "belt.obj", &belt(2.5, 0.0, 24));
    fs::write(path.join("all.pin"), "71").unwrap();
    let arguments = ["belt.obj", "--body", "ball.obj", "-o", "out.obj", "--pin", "all.pin"];
    assert_eq!(code(&fix(&arguments, path)), 0);
    fs::write(path.join("all.pin"), "72").unwrap();
    fs::remove_file(path.join("out.obj")).unwrap();
    assert!(complaint(&arguments, path).contains("vertex 72 does not exist, there are vertices 0 to 71"));
}

#[test]
fn fix_never_overwrites_a_body() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write(path, "ball.obj", &ball(&[[0.0; 3]], 12));
    write(path, "belt.obj", &belt(2.5, 0.0, 24));
    let text = complaint(&["belt.obj", "--body", "ball.obj", "-o", "ball.obj", "--overwrite"], path);
    assert!(text.contains("ball.obj"), "{text}");
    assert!(complaint(&["belt.obj", "--body", "no.obj", "-o", "out.obj"], path).contains("no.obj"));
}

#[test]
fn report_of_fix_beside_a_body_has_every_field_of_the_contract() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write(path, "ball.obj", &ball(&[[0.0; 3]], 16));
    write(path, "belt.obj", &belt(1.01, 0.04, 36));
    let output = fix(&["belt.obj", "--body", "ball.obj", "-o", "out.obj", "--json"], path);
    let report = json(&output);
    for at in ["before", "after"] {
        for name in ["num_body_face_pairs", "num_vertices_inside_body"] {
            assert!(report[at][name].is_u64(), "{at} {name}: {report}");
        }
    }
    assert_eq!(report["bodies"], serde_json::json!([{"file": "ball.obj", "num_own_face_pairs": 0}]));
    let text = String::from_utf8(fix(&["belt.obj", "--body", "ball.obj", "-o", "out2.obj"], path).stdout).unwrap();
    assert!(text.contains("with bodies: ") && text.contains("ball.obj"), "{text}");
}

#[test]
fn fix_of_a_cloth_pinned_inside_of_a_body_blocks_it_and_finishes_all_else() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write(path, "ball.obj", &ball(&[[0.0; 3]], 24));
    let (inner, outer) = (belt(0.8, 0.0, 36), belt(1.01, 0.04, 36));
    write(path, "inner.obj", &inner);
    write(path, "outer.obj", &outer);
    let num_inner = inner.positions.len();
    let pins = |vertices: &[usize]| vertices.iter().map(usize::to_string).collect::<Vec<_>>().join(" ");
    fs::write(path.join("inner.pin"), pins(&(0..num_inner).collect::<Vec<_>>())).unwrap();
    let arguments = ["inner.obj", "outer.obj", "--body", "ball.obj", "-o", "out.obj", "--json", "--pin", "inner.pin"];
    let output = fix(&arguments, path);
    let report = json(&output);
    assert_eq!((code(&output), &report["after"]["num_face_pairs"]), (1, &0.into()));
    assert_eq!(report["after"]["num_vertices_inside_body"], num_inner);
    assert_eq!(report["blocked"].as_array().unwrap().len(), 1);
    assert_eq!(report["blocked"][0]["reason"], "all its vertices are pinned, inside of a body");
    assert_eq!(report["blocked"][0]["num_vertices_inside_body"], num_inner);
    assert!(report["num_iterations"].as_u64() < Some(10), "{}", report["num_iterations"]);

    // Two vertices of the deepest part of a belt.
    let at_left = |(_, place): &(usize, &[f64; 3])| place[0] < -0.96 && place[1] < 0.2 && place[2].abs() < 0.1;
    let deepest: Vec<usize> = outer.positions.iter().enumerate().filter(at_left).map(|(index, _)| index).collect();
    assert!((1..4).contains(&deepest.len()), "{deepest:?}");
    fs::write(path.join("outer.pin"), pins(&deepest)).unwrap();
    let arguments = ["outer.obj", "--body", "ball.obj", "-o", "two.obj", "--json", "--pin", "outer.pin"];
    let report = json(&fix(&arguments, path));
    let inside = report["after"]["num_vertices_inside_body"].as_u64().unwrap();
    assert!(inside >= deepest.len() as u64 && inside < 12, "{}", report["after"]);
    let reasons: Vec<_> = report["blocked"].as_array().unwrap().iter().map(|path| &path["reason"]).collect();
    assert!(reasons.contains(&&"a part of it is pinned inside of a body".into()) || inside == deepest.len() as u64);
    assert!(report["history"].as_array().unwrap().iter().any(|step| step["method"] == "settle"), "{reasons:?}");
}

#[test]
fn fix_of_a_ball_that_can_not_leave_the_ball_round_it_ends_early_and_says_why() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write(path, "ball.obj", &ball(&[[0.0; 3]], 24));
    // Its vertices are to go outwards in all directions, to twice its size.
    let mut inner = Sheet::default();
    inner.add_ball([0.0; 3], 0.5, 16);
    write(path, "inner.obj", &inner);
    let output = fix(&["inner.obj", "--body", "ball.obj", "-o", "out.obj", "--json"], path);
    assert_eq!(code(&output), 1);
    let report = json(&output);
    let num_iterations = report["num_iterations"].as_u64().unwrap();
    assert!(num_iterations <= 25, "{num_iterations}");
    let blocked = report["blocked"].as_array().unwrap();
    assert_eq!(blocked.len(), 1, "{blocked:?}");
    assert!(blocked[0]["reason"].as_str().unwrap().contains("no motion brought it out of the body"), "{blocked:?}");
    assert_eq!(report["after"]["num_vertices_inside_body"], inner.positions.len());
}
