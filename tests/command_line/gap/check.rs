//! `--gap` and `--gap-for` of `untangled check`.

use std::{fs, path::Path, process::Output};

use serde_json::Value;

use super::sheets;
use crate::mesh_folder::{code, command, json};

fn check(folder: &Path, arguments: &[&str]) -> Output {
    command("check", folder).args(arguments).output().unwrap()
}

fn gap(folder: &Path, arguments: &[&str]) -> (i32, Value) {
    let output = check(folder, &[arguments, &["--json"]].concat());
    (code(&output), json(&output)["gap"].clone())
}

#[test]
fn check_with_gap_counts_pairs_below_exactly_and_ends_with_1_where_there_are_any() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("a.obj"), sheets(0.125)).unwrap();
    let (code, report) = gap(path, &["a.obj", "--gap", "0.125"]);
    assert_eq!((code, &report["num_pairs_below"], &report["asked_m"]), (0, &0.into(), &0.125.into()));
    assert_eq!(report["min_distance_m"], 0.125);
    let (code, report) = gap(path, &["a.obj", "--gap", "0.12500000000000003"]);
    // Four corners over the floor, and five edges across the diagonal or along it.
    assert_eq!((code, &report["min_distance_m"]), (1, &0.125.into()));
    let count = report["num_pairs_below"].as_u64().unwrap();
    assert!((4..=9).contains(&count), "{report}");
    let sides = report["nearest"]["sides"].as_array().unwrap();
    assert_eq!(sides.len(), 2);
    assert!(sides.iter().all(|side| side["file"] == "a.obj"));
    let parts: Vec<&str> = sides.iter().map(|side| side["part"].as_str().unwrap()).collect();
    assert!(parts[0] != parts[1], "{report}");
    assert!(gap(path, &["a.obj"]).1.is_null());
}

#[test]
fn check_with_gap_tells_people_the_nearest_pair_by_file_and_vertices_from_0() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("a.obj"), "v 0 0 0\nv 4 0 0\nv 0 4 0\nf 1 2 3\n").unwrap();
    fs::write(path.join("b.obj"), "v 1 1 0.25\nv 1 1.5 3\nv 1.5 1 3\nf 1 2 3\n").unwrap();
    let output = check(path, &["a.obj", "b.obj", "--gap", "0.5"]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("no intersections"), "{text}");
    assert!(text.contains("gap of 0.5 m: 1 primitive pair is nearer"), "{text}");
    assert!(text.contains("nearest, at 2.5e-1 m: vertex 0 of b.obj, and face 0 1 2 of a.obj"), "{text}");
    let output = check(path, &["a.obj", "--gap", "0.5"]);
    assert!(String::from_utf8(output.stdout).unwrap().contains("no two primitives without a common vertex"));
}

#[test]
fn check_with_gap_does_not_count_pairs_that_share_a_welded_vertex() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    // Two triangles with a common edge, its vertices there twice.
    fs::write(path.join("a.obj"), "v 0 0 0\nv 4 0 0\nv 0 4 0\nv 4 0 0\nv 0 4 0\nv 4 4 0\nf 1 2 3\nf 4 6 5\n").unwrap();
    assert_eq!(gap(path, &["a.obj", "--gap", "0.1"]).0, 0);
    let (code, report) = gap(path, &["a.obj", "--gap", "0.1", "--weld", "off"]);
    assert_eq!((code, &report["min_distance_m"]), (1, &0.0.into()));
}

#[test]
fn gap_for_a_tool_says_what_it_took_and_bad_numbers_are_usage_errors() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("a.obj"), sheets(0.125)).unwrap();
    let output = check(path, &["a.obj", "--json", "--gap-for", "libuipc:thickness=0.0625"]);
    assert_eq!(code(&output), 1, "libuipc refuses pairs at exactly two thicknesses");
    let report = &serde_json::from_slice::<Value>(&output.stdout).unwrap()["gap"];
    assert_eq!((&report["for"]["tool"], &report["for"]["thickness_m"]), (&"libuipc".into(), &0.0625.into()));
    assert!(String::from_utf8_lossy(&output.stderr).contains("libuipc with thickness 0.0625 m: --gap 0.125000125"));
    assert_eq!(code(&check(path, &["a.obj", "--gap-for", "ppf:contact_gap=0.0625"])), 0);
    for bad in [
        &["--gap", "nan"][..],
        &["--gap", "-0.1"],
        &["--gap", "0"],
        &["--gap-for", "bullet"],
        &["--gap-for", "newton:margin=nan"],
        &["--gap", "0.1", "--gap-for", "ppf"],
    ] {
        let output = check(path, &[&["a.obj"], bad].concat());
        assert_eq!(code(&output), 2, "{bad:?}");
        assert!(String::from_utf8_lossy(&output.stderr).contains("--gap"), "{bad:?}");
    }
}
