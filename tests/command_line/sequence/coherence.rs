//! The way of a vertex changes from frame to frame no more abruptly than a smooth correction needs; roles are honoured.

use std::fs;

use untangled_testkit::{
    files::formats::obj,
    generate::Sheet,
    shots::{FlapShot, pc2},
};

use super::{code, folder, frames, lines, run};

#[test]
fn fix_of_a_cache_corrects_about_as_smoothly_as_a_bump_of_that_height() {
    let folder = folder();
    let output = run(&["fix", "cloth.obj", "--cache", "in.pc2", "-o", "out.pc2", "--json"], folder.path());
    let (_, totals) = lines(&output);
    let smooth = |name: &str| totals["smoothness"][name].as_f64().unwrap();
    // A correction of one frame alone has 28.
    assert!(smooth("num_vertices") > 10.0 && smooth("max_correction_m") > 1e-3, "{totals}");
    assert!(smooth("max_ratio_to_smooth") < 6.0, "{totals}");
    assert!(smooth("mean_ratio_to_smooth") < 2.0, "{totals}");
}

#[test]
fn fix_of_a_cache_keeps_pins_and_moves_cloth_out_of_a_body_that_moves() {
    let folder = folder();
    let path = folder.path();
    let shot = FlapShot { ball_middle: Some(11.5), tangles: Vec::new(), ..FlapShot::small() };
    let cloth: Vec<Sheet> = (0..24).map(|frame| shot.cloth(frame)).collect();
    let balls: Vec<Sheet> = (0..24).map(|frame| shot.ball(frame)).collect();
    fs::write(path.join("ball.obj"), obj(&balls[0], false)).unwrap();
    fs::write(path.join("ball.pc2"), pc2(&balls)).unwrap();
    fs::write(path.join("flag.pc2"), pc2(&cloth)).unwrap();
    let pins: Vec<String> = (0..25).map(|vertex| vertex.to_string()).collect();
    fs::write(path.join("pins"), pins.join(" ")).unwrap();
    let body = ["--body", "ball.obj", "--body-cache", "ball.pc2"];
    let check = run(&[&["check", "cloth.obj", "--cache", "flag.pc2", "--json"], &body[..]].concat(), path);
    let (before, _) = lines(&check);
    assert!(before.iter().any(|line| line["before"]["num_body_face_pairs"].as_u64() > Some(0)));
    assert!(before.iter().any(|line| line["clean"] == true));
    let fix = ["fix", "cloth.obj", "--cache", "flag.pc2", "-o", "out.pc2", "--json", "--pin", "pins"];
    let output = run(&[&fix[..], &body].concat(), path);
    let (after, totals) = lines(&output);
    assert_eq!(code(&output), 0, "{totals}");
    for line in after {
        assert_eq!(line["after"]["num_body_face_pairs"], 0);
        assert_eq!(line["after"]["num_vertices_inside_body"], 0);
        assert_eq!(line["after"]["certificate"]["num_vertices_inside_body_single"], 0);
    }
    let [input, output] = ["flag.pc2", "out.pc2"].map(|name| fs::read(path.join(name)).unwrap());
    for (input, output) in super::frames_of(&input).iter().zip(super::frames_of(&output)) {
        assert_eq!(input[..12 * 25], output[..12 * 25]);
    }
    assert!(input != output);
}

#[test]
fn fix_of_a_cache_opens_the_gap_in_each_frame() {
    let folder = folder();
    let path = folder.path();
    let cut: Vec<Sheet> = frames().drain(8..12).collect();
    fs::write(path.join("cut.pc2"), pc2(&cut)).unwrap();
    let output = run(&["fix", "cloth.obj", "--cache", "cut.pc2", "-o", "out.pc2", "--json", "--gap", "0.002"], path);
    let (reported, totals) = lines(&output);
    assert_eq!(code(&output), 0, "{totals}");
    for line in reported {
        assert_eq!(line["gap"]["num_pairs_below"], 0, "{line}");
        assert_eq!(line["gap"]["certificate"]["num_pairs_below_single"], 0);
    }
    let check = run(&["check", "cloth.obj", "--cache", "out.pc2", "--gap", "0.002"], path);
    assert_eq!(code(&check), 0, "{check:?}");
}
