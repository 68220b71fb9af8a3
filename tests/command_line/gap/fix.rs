//! `--gap` of `untangled fix`.

use std::{fs, path::Path};

use serde_json::Value;
use untangled_testkit::files::shared;

use super::{grids, rules, sheets};
use crate::mesh_folder::{code, fix, json};

/// The gap of a repair's report, which has to be clean, and kept in both precisions by both counts.
fn kept(report: &Value, asked_m: f64) {
    let gap = &report["gap"];
    assert_eq!((&report["clean"], &gap["num_pairs_below"]), (&true.into(), &0.into()), "{gap}");
    assert_eq!(gap["certificate"], serde_json::json!({ "num_pairs_below": 0, "num_pairs_below_single": 0 }));
    assert_eq!(gap["infeasible"], serde_json::json!([]));
    assert!(gap["min_distance_m"].as_f64().unwrap() >= asked_m, "{gap}");
}

#[test]
fn fix_with_gap_of_a_file_that_keeps_it_writes_it_unchanged() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("a.obj"), sheets(0.25)).unwrap();
    let output = fix(&["a.obj", "-o", "b.obj", "--json", "--gap", "0.2"], path);
    assert_eq!(code(&output), 0);
    let report = json(&output);
    kept(&report, 0.2);
    assert_eq!((&report["num_iterations"], &report["gap"]["num_pairs_below_before"]), (&0.into(), &0.into()));
    assert_eq!(fs::read(path.join("a.obj")).unwrap(), fs::read(path.join("b.obj")).unwrap());
}

#[test]
fn fix_with_gap_sets_clean_sheets_apart_at_each_resolution_and_in_each_format() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    for cells in [6, 12, 24] {
        fs::write(path.join("a.obj"), grids(cells, 0.0005)).unwrap();
        // Parts of the edge of the coarsest grid.
        for gap_m in [0.01 / 6.0, 0.1 / 6.0] {
            for out in ["b.obj", "b.ply"] {
                let gap = gap_m.to_string();
                let output = fix(&["a.obj", "-o", out, "--overwrite", "--json", "--gap", &gap], path);
                let report = json(&output);
                assert_eq!(code(&output), 0, "{cells} {gap_m} {out}: {}", report["gap"]);
                kept(&report, gap_m);
                assert!(report["gap"]["num_pairs_below_before"].as_u64().unwrap() > 0);
                let history = report["history"].as_array().unwrap();
                assert!(!history.is_empty() && history.iter().all(|step| step["method"] == "gap"), "{history:?}");
                let stretch = report["distortion"]["max_edge_stretch"].as_f64().unwrap();
                assert!((0.8..1.25).contains(&stretch), "{stretch}");
            }
        }
    }
}

#[test]
fn fix_for_libuipc_and_ppf_satisfies_their_rules_in_both_precisions() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("a.obj"), grids(8, 0.0005)).unwrap();
    let args = |preset: &'static str| ["a.obj", "-o", "b.obj", "--overwrite", "--gap-for", preset];
    assert_eq!(code(&fix(&args("libuipc:thickness=0.002"), path)), 0);
    for single in [false, true] {
        let mesh = rules::TestMesh::read(&path.join("b.obj"), single);
        // A pair fails when its squared distance is at most (t_i + t_j)^2.
        let limit = (0.002 + 0.002) * (0.002 + 0.002);
        assert!(mesh.squared_distances().into_iter().all(|squared| squared > limit));
        let before = rules::TestMesh::read(&path.join("a.obj"), single);
        assert!(before.squared_distances().into_iter().any(|squared| squared <= limit));
    }
    assert_eq!(code(&fix(&args("ppf:contact_gap=0.001,contact_offset=0.0005"), path)), 0);
    for single in [false, true] {
        let mesh = rules::TestMesh::read(&path.join("b.obj"), single);
        // What the offsets leave is at least two contact gaps.
        let clearance = |squared: f64| squared.sqrt() - 2.0 * 0.0005;
        assert!(mesh.squared_distances().into_iter().all(|squared| clearance(squared) > 2.0 * 0.001 - 1e-9));
    }
}

#[test]
fn fix_with_gap_between_pinned_sheets_names_the_place_and_ends_with_1() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("a.obj"), sheets(0.05)).unwrap();
    fs::write(path.join("pins"), "0 1 2 3 4 5 6 7").unwrap();
    let output = fix(&["a.obj", "-o", "b.obj", "--json", "--gap", "0.1", "--pin", "pins"], path);
    assert_eq!(code(&output), 1);
    let report = json(&output);
    assert_eq!(report["clean"], false);
    let places = report["gap"]["infeasible"].as_array().unwrap();
    assert_eq!(places.len(), 1, "{places:?}");
    assert!(places[0]["reason"].as_str().unwrap().contains("pinned"));
    assert!((places[0]["distance_m"].as_f64().unwrap() - 0.05).abs() < 1e-12);
    let owners: Vec<&str> =
        places[0]["owners"].as_array().unwrap().iter().map(|side| side["part"].as_str().unwrap()).collect();
    assert_eq!(owners, ["object \"floor\"", "object \"lid\""]);
    assert_eq!(fs::read(path.join("a.obj")).unwrap(), fs::read(path.join("b.obj")).unwrap());
    let text = fix(&["a.obj", "-o", "c.obj", "--gap", "0.1", "--pin", "pins"], path).stdout;
    let text = String::from_utf8(text).unwrap();
    assert!(text.contains("too close: ") && text.contains("all its vertices are pinned"), "{text}");
}

#[test]
fn fix_with_gap_beside_a_body_names_the_body_and_its_vertices() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let sheet =
        |name: &str, z: f64| format!("o {name}\nv 0 0 {z}\nv 4 0 {z}\nv 4 4 {z}\nv 0 4 {z}\nf 1 2 3\nf 1 3 4\n");
    fs::write(path.join("a.obj"), sheet("lid", 0.05)).unwrap();
    fs::write(path.join("b.obj"), sheet("floor", 0.0)).unwrap();
    fs::write(path.join("pins"), "0 1 2 3").unwrap();
    let output = fix(&["a.obj", "--body", "b.obj", "-o", "c.obj", "--json", "--gap", "0.1", "--pin", "pins"], path);
    assert_eq!(code(&output), 1);
    let gap = &json(&output)["gap"];
    let mut files: Vec<&str> =
        gap["nearest"]["sides"].as_array().unwrap().iter().map(|side| side["file"].as_str().unwrap()).collect();
    files.sort_unstable();
    assert_eq!(files, ["a.obj", "b.obj"], "{gap}");
    let owners = gap["infeasible"][0]["owners"].as_array().unwrap();
    assert_eq!(owners.len(), 2, "{gap}");
    assert_eq!((&owners[1]["file"], &owners[1]["part"]), (&"b.obj".into(), &"object \"floor\"".into()));
    assert_eq!(owners[1]["vertices_in_file"], serde_json::json!([0, 1, 2, 3]));
    let text = fix(&["a.obj", "--body", "b.obj", "-o", "d.obj", "--gap", "0.1", "--pin", "pins"], path).stdout;
    let text = String::from_utf8(text).unwrap();
    assert!(text.contains("of b.obj, object \"floor\""), "{text}");
    assert!(text.contains("nothing intersects, but the gap is not kept"), "{text}");
}

/// Mean edge of an OBJ.
fn mean_edge(path: &Path) -> f64 {
    rules::TestMesh::read(path, false).mean_edge()
}

#[test]
fn fix_with_gap_of_tangled_scenes_certifies_one_and_ten_parts_of_a_hundred_of_the_edge() {
    let Some(scenes) = shared("scenes") else { return };
    let folder = tempfile::tempdir().unwrap();
    for name in ["cross_coarse", "eight_coarse", "ll_coarse", "bli_cone_coarse", "closed_finger_coarse"] {
        let scene = scenes.join(name).with_extension("obj");
        for part in [0.01, 0.1] {
            let gap_m = part * mean_edge(&scene);
            let input = scene.display().to_string();
            let arguments = [&input, "-o", "b.obj", "--overwrite", "--json", "--gap", &gap_m.to_string()];
            let output = fix(&arguments, folder.path());
            let report = json(&output);
            assert_eq!(code(&output), 0, "{name} {part}: {}", report["gap"]);
            kept(&report, gap_m);
        }
    }
}

#[test]
fn fix_with_gap_beside_a_tangle_that_stays_sets_the_rest_apart_and_names_the_tangle() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    // Two pinned squares that cross, far from two sheets that are too close.
    let pinned = "o fixed\nv 50 0 0\nv 52 0 0\nv 52 2 0\nv 50 2 0\nv 51 -1 -1\nv 51 3 -1\nv 51 3 1\nv 51 -1 1\n\
                  f 1 2 3\nf 1 3 4\nf 5 6 7\nf 5 7 8\n";
    fs::write(path.join("fixed.obj"), pinned).unwrap();
    fs::write(path.join("sheets.obj"), grids(8, 0.0005)).unwrap();
    fs::write(path.join("pins"), "0 1 2 3 4 5 6 7").unwrap();
    let arguments = ["fixed.obj", "sheets.obj", "-o", "out", "--json", "--gap", "0.002", "--pin", "pins"];
    fs::create_dir(path.join("out")).unwrap();
    let output = fix(&arguments, path);
    assert_eq!(code(&output), 1);
    let report = json(&output);
    let gap = &report["gap"];
    let before = gap["num_pairs_below_before"].as_u64().unwrap();
    assert!(gap["num_pairs_below"].as_u64().unwrap() < before.min(20), "{gap}");
    let places = gap["infeasible"].as_array().unwrap();
    assert!(!places.is_empty(), "{gap}");
    for place in places {
        assert!(place["reason"].as_str().unwrap().contains("tangle"), "{place}");
        assert_eq!(place["owners"][0]["file"], "fixed.obj", "{place}");
    }
}
