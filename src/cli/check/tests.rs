//! Checks of files as a user has them.

use std::fs;

use super::*;

/// Two triangles through each other, in two files.
fn crossing() -> (tempfile::TempDir, Vec<PathBuf>) {
    let folder = tempfile::tempdir().unwrap();
    let paths: Vec<PathBuf> = ["a.obj", "b.obj"].iter().map(|name| folder.path().join(name)).collect();
    fs::write(&paths[0], "v 0 0 0\nv 1 0 0.01\nv 0 1 0.02\nf 1 2 3\n").unwrap();
    fs::write(&paths[1], "v 0.2 0.2 -1\nv 0.3 0.25 1\nv 0.25 0.4 -1\nf 1 2 3\n").unwrap();
    (folder, paths)
}

#[test]
fn check_of_crossing_triangles_reports_every_field_of_the_contract() {
    let (_folder, files) = crossing();
    let (report, _) = check(&files, WeldArg::Exact, true).unwrap();
    let json: serde_json::Value = serde_json::from_str(&report.to_json()).unwrap();
    assert_eq!(json["schema"], "untangled.check/1");
    let counts = [("num_vertices", 6), ("num_faces", 2), ("num_pieces", 2), ("num_boundary_edges", 6)];
    for (field, expected) in counts {
        assert_eq!(json[field], expected, "{field}");
    }
    assert_eq!((&json["closed"], &json["manifold"]), (&false.into(), &true.into()));
    assert_eq!(json["num_edge_face_intersections"], 2);
    assert_eq!(json["face_pairs"], serde_json::json!([[0, 1]]));
    assert_eq!(json["path_pairs"], serde_json::json!({"BB/II": 1}));
    let path = &json["paths"][0];
    assert_eq!((&path["pair_type"], &path["num_segments"]), (&"BB/II".into(), &1.into()));
    assert_eq!(path["ends"][0]["kind"], "boundary");
    assert_eq!(path["ends"][0]["edge"].as_array().unwrap().len(), 2);
    assert_eq!(path["copies"].as_array().unwrap().len(), 2);
    let copies = path["copies"].as_array().unwrap();
    let ii = copies.iter().find(|copy| copy["type"] == "II").unwrap();
    assert!(ii["inside_vertices"].is_null() && ii["partitioning"] == false && ii["num_segments"] == 1);
    let bb = copies.iter().find(|copy| copy["type"] == "BB").unwrap();
    assert!(bb["inside_vertices"].is_array() && bb["partitioning"] == true);
    for stage in ["read", "mesh", "intersect", "paths", "regions"] {
        assert!(json["time_us"][stage].is_u64(), "{stage}");
    }
    let table = report.to_string();
    assert!(table.contains("1 intersecting face pair, 2 edge-face intersections"), "{table}");
    assert!(table.contains("BB/II"), "{table}");
}

#[test]
fn check_of_bad_files_names_the_file_and_the_element() {
    let (_folder, files) = crossing();
    fs::write(&files[1], "v 0 0 0\nv 1 1e200 0\nv 2 0 1\nf 1 2 3\n").unwrap();
    let message = check(&files, WeldArg::Exact, false).unwrap_err().to_string();
    assert!(message.contains("b.obj:2: vertex 2 has coordinate y"), "{message}");
}

#[test]
fn contours_format_of_an_input_or_of_another_format_is_an_error() {
    let (folder, files) = crossing();
    let contours = |name: &str| contours_format(&folder.path().join(name), &files, false);
    assert!(matches!(contours("a.obj"), Err(CheckError::ContoursOverInput(_))));
    std::os::unix::fs::symlink(&files[0], folder.path().join("link.ply")).unwrap();
    assert!(matches!(contours("link.ply"), Err(CheckError::ContoursOverInput(_))));
    assert!(matches!(contours("c.glb"), Err(CheckError::ContoursFormat(_))));
    assert_eq!(contours("c.PLY").unwrap(), FileFormat::Ply);
    fs::write(folder.path().join("c.ply"), "").unwrap();
    assert!(matches!(contours("c.ply"), Err(CheckError::ContoursExist(_))));
    assert_eq!(contours_format(&folder.path().join("c.ply"), &files, true).unwrap(), FileFormat::Ply);
}
