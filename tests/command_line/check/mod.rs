//! `untangled check` as a user or a script runs it.

mod formats;

use std::{
    fs,
    path::Path,
    process::{Command, Output},
};

use serde_json::Value;
use untangled_testkit::{files::shared, process::untangled};

fn check(arguments: &[&str], folder: &Path) -> Output {
    Command::new(untangled()).arg("check").args(arguments).current_dir(folder).output().unwrap()
}

fn code(output: &Output) -> i32 {
    output.status.code().unwrap()
}

fn json(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).unwrap()
}

/// What stands on standard error: one line.
fn complaint(output: &Output) -> String {
    assert_eq!(code(output), 2, "{output:?}");
    assert!(output.stdout.is_empty(), "{output:?}");
    let text = String::from_utf8(output.stderr.clone()).unwrap();
    assert_eq!(text.trim_end().lines().count(), 1, "{text}");
    text
}

/// A folder with a square, a triangle that pierces it, and one that does not.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("square.obj", "v 0 0 0\nv 1 0 0.01\nv 1 1 0\nv 0 1 0.02\nf 1 2 3 4\n");
    write("spike.obj", "v 0.2 0.1 -1\nv 0.3 0.25 1\nv 0.25 0.4 -1\nf -3 -2 -1\n");
    write(
        "far.ply",
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
         element face 1\nproperty list uchar int vertex_indices\nend_header\n9 0 0\n9 1 0\n9 0 1\n3 0 1 2\n",
    );
    folder
}

#[test]
fn check_of_a_clean_file_exits_0_and_reports_counts() {
    let folder = folder();
    let output = check(&["square.obj"], folder.path());
    assert_eq!(code(&output), 0);
    assert!(String::from_utf8_lossy(&output.stdout).contains("no intersections"));
    let report = json(&check(&["square.obj", "--json"], folder.path()));
    assert_eq!(
        (&report["num_vertices"], &report["num_faces"], &report["num_pieces"]),
        (&4.into(), &2.into(), &1.into())
    );
    assert_eq!((&report["num_boundary_edges"], &report["num_face_pairs"]), (&4.into(), &0.into()));
    assert_eq!((&report["path_pairs"], &report["paths"]), (&serde_json::json!({}), &serde_json::json!([])));
    assert_eq!(report.get("face_pairs"), None);
}

#[test]
fn check_of_several_files_takes_them_as_one_mesh() {
    let folder = folder();
    let output = check(&["square.obj", "spike.obj", "far.ply", "--json", "--face-pairs"], folder.path());
    assert_eq!(code(&output), 1);
    let report = json(&output);
    assert_eq!(report["schema"], "untangled.check/1");
    assert_eq!((&report["num_pieces"], &report["num_faces"]), (&3.into(), &4.into()));
    let pairs = report["face_pairs"].as_array().unwrap();
    assert_eq!(pairs.len(), usize::try_from(report["num_face_pairs"].as_u64().unwrap()).unwrap());
    assert!(pairs.iter().all(|pair| pair[1] == 2), "{pairs:?}");
    let segments: u64 = report["paths"].as_array().unwrap().iter().map(|p| p["num_segments"].as_u64().unwrap()).sum();
    assert_eq!(report["num_face_pairs"], segments);
    assert_eq!(report["path_pairs"], serde_json::json!({"BB/II": 1}));
    // The same bytes again, but for the clock.
    let mut again = json(&check(&["square.obj", "spike.obj", "far.ply", "--json", "--face-pairs"], folder.path()));
    again["time_us"] = report["time_us"].clone();
    assert_eq!(again, report);
}

#[test]
fn check_of_bad_input_exits_2_with_one_line_that_names_it() {
    let folder = folder();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("short.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n\nf 1 2 900\n");
    write("nan.obj", "v 0 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3\n");
    write("points.obj", "v 0 0 0\n");
    write("line.obj", "v 0 0 0\nv 1 0 0\nf 1 1 2\n");
    let cases = [
        ("short.obj", "short.obj:5: face 1 refers to vertex 900, but only 3 are defined"),
        ("nan.obj", "nan.obj:2: vertex 2 has coordinate NaN"),
        ("points.obj", "points.obj: no mesh in it: 1 vertices, 0 faces"),
        ("line.obj", "line.obj: none of the 1 faces has three different vertices"),
        ("missing.obj", "missing.obj: can't be read: "),
        (".", "can't be read"),
    ];
    for (name, expected) in cases {
        let text = complaint(&check(&[name], folder.path()));
        assert!(text.contains(expected), "{text}");
        // Beside a good file it is still refused, unless the two together are a mesh.
        if name != "line.obj" {
            let text = complaint(&check(&["square.obj", name, "--json"], folder.path()));
            assert!(text.contains(expected), "{text}");
        }
    }
    assert_eq!(code(&check(&[], folder.path())), 2);
    assert_eq!(code(&check(&["square.obj", "--no-such-option"], folder.path())), 2);
}

#[test]
fn check_contours_writes_lines_and_never_an_input() {
    let folder = folder();
    let files = ["square.obj", "spike.obj"];
    for name in ["lines.obj", "lines.ply"] {
        assert_eq!(code(&check(&[files[0], files[1], "--contours", name], folder.path())), 1);
    }
    let obj = fs::read_to_string(folder.path().join("lines.obj")).unwrap();
    assert!(obj.starts_with("g BB_II_0\nv ") && obj.lines().last().unwrap().starts_with("l 1 2"), "{obj}");
    let ply = fs::read_to_string(folder.path().join("lines.ply")).unwrap();
    assert!(ply.contains("element edge "), "{ply}");
    let text = complaint(&check(&[files[0], files[1], "--contours", "lines.obj"], folder.path()));
    assert!(text.contains("lines.obj: exists; --overwrite replaces it"), "{text}");
    let again = check(&[files[0], files[1], "--contours", "lines.obj", "--overwrite"], folder.path());
    assert_eq!((code(&again), fs::read_to_string(folder.path().join("lines.obj")).unwrap()), (1, obj));
    let before = fs::read(folder.path().join("spike.obj")).unwrap();
    let text = complaint(&check(&[files[0], files[1], "--contours", "./spike.obj"], folder.path()));
    assert!(text.contains("is an input"), "{text}");
    assert_eq!(fs::read(folder.path().join("spike.obj")).unwrap(), before);
    complaint(&check(&[files[0], "--contours", "lines.stl"], folder.path()));
}

#[test]
fn check_says_that_tiny_coordinates_count_as_zero() {
    let folder = folder();
    fs::write(folder.path().join("tiny.obj"), "v 0 0 0\nv 1 0 1e-80\nv 0 1 0\nf 1 2 3\n").unwrap();
    let output = check(&["tiny.obj", "--json"], folder.path());
    assert_eq!(json(&output)["num_zeroed_coordinates"], 1);
    let text = check(&["tiny.obj"], folder.path()).stdout;
    assert!(String::from_utf8_lossy(&text).contains("1 coordinate below 2^-250 m counts as zero"));
}

#[test]
fn check_says_who_meets_whom_and_how_long_it_took_only_when_asked() {
    let folder = folder();
    fs::write(folder.path().join("named.obj"), "v 0 0 0\nv 1 0 0.01\nv 1 1 0\nv 0 1 0.02\no floor\nf 1 2 3 4\n")
        .unwrap();
    let report = json(&check(&["named.obj", "spike.obj", "--json"], folder.path()));
    let count = &report["num_face_pairs"];
    let between = ["named.obj, object \"floor\"", "spike.obj"];
    assert_eq!(report["meetings"], serde_json::json!([{"between": between, "num_face_pairs": count}]));
    for (more, is_timed) in [(&[][..], false), (&["-v"], true), (&["--verbose"], true)] {
        let output = check(&[&["named.obj", "spike.obj"], more].concat(), folder.path());
        let text = String::from_utf8(output.stdout).unwrap();
        assert_eq!(text.contains("intersect "), is_timed, "{text}");
        assert!(text.contains("named.obj, object \"floor\" and spike.obj"), "{text}");
    }
}

#[test]
fn check_of_real_garments_finds_the_known_counts() {
    let Some(data) = shared("data") else { return };
    for (name, pairs, exit) in [("tshirt_trifold_3k7.obj", 117, 1), ("unisex_shirt_12k7.obj", 0, 0)] {
        let output = check(&[name, "--json"], &data);
        assert_eq!((&json(&output)["num_face_pairs"], code(&output)), (&pairs.into(), exit), "{name}");
    }
}
