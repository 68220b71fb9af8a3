//! `untangled demo` as a user runs it: two processes, shared memory, files.

use std::{fs, process::Command};

use untangled_checker::count_edge_face;
use untangled_publisher::obj;
use untangled_testkit::process::untangled;

#[test]
fn demo_ends_clean_and_writes_its_files() {
    let folder = tempfile::tempdir().unwrap();
    let runtime = tempfile::tempdir().unwrap();
    let output = Command::new(untangled())
        .args(["demo", "--frames", "100", "--out"])
        .arg(folder.path())
        .args(["--", "--scene", "crease", "--edge-m", "0.04"])
        .env("XDG_RUNTIME_DIR", runtime.path())
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stdout);
    assert_eq!(output.status.code(), Some(0), "{said}{}", String::from_utf8_lossy(&output.stderr));
    assert!(said.contains("it stays tangled"), "the control came clean without corrections: {said}");
    for (name, clean) in [("before", false), ("after", true)] {
        let cloth = obj::read(&folder.path().join(name).with_extension("obj")).unwrap();
        assert_eq!(count_edge_face(&cloth.points(), &cloth.triangles) == Ok(0), clean, "{name}");
        let picture = fs::read(folder.path().join(name).with_extension("png")).unwrap();
        assert!(picture.starts_with(b"\x89PNG") && picture.len() > 1000);
    }
    let left: Vec<_> =
        fs::read_dir(runtime.path().join("untangled")).unwrap().map(|entry| entry.unwrap().path()).collect();
    assert!(left.is_empty(), "the daemon has left {left:?}");
}

/// Each type of path, by daemon and host, with a control without corrections, which must stay tangled.
#[test]
fn demo_of_each_path_type_ends_clean() {
    for (scene, path_type) in [
        ("bag", "CLOSED"),
        ("tongue", "BB/II"),
        ("curtains", "BI/BI"),
        ("crease", "LL"),
        ("twist", "BLI"),
        ("drop", "EIGHT"),
        ("wedge", "CROSS"),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let output = Command::new(untangled())
            .args(["demo", "--frames", "100", "--out"])
            .arg(folder.path())
            .args(["--", "--edge-m", "0.04", "--scene", scene])
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stdout);
        assert_eq!(output.status.code(), Some(0), "{scene}: {said}{}", String::from_utf8_lossy(&output.stderr));
        assert!(said.contains("it stays tangled"), "{scene} came clean without corrections: {said}");
        assert!(said.contains(path_type), "{scene} without {path_type}: {said}");
        let cloth = obj::read(&folder.path().join("after.obj")).unwrap();
        assert_eq!(count_edge_face(&cloth.points(), &cloth.triangles), Ok(0), "{scene}");
    }
}

#[test]
fn demo_of_a_file_that_is_no_mesh_is_refused_with_its_line() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("broken.obj");
    fs::write(&file, "v 0 0 0\nf 1 2 3\n").unwrap();
    let output = Command::new(untangled()).args(["demo", "--out"]).args([folder.path(), &file]).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(said.contains("broken.obj:2: "), "{said}");
}

#[test]
fn demo_without_control_shows_the_untangling_alone() {
    let folder = tempfile::tempdir().unwrap();
    let output = Command::new(untangled())
        .args(["demo", "--no-control", "--frames", "100", "--out"])
        .arg(folder.path())
        .args(["--", "--scene", "crease", "--edge-m", "0.04"])
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stdout);
    assert_eq!(output.status.code(), Some(0), "{said}{}", String::from_utf8_lossy(&output.stderr));
    assert!(!said.contains("Control"), "{said}");
}
