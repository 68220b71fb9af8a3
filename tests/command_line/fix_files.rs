//! `untangled fix`: which files it writes, and with which bytes.

use std::{
    fs,
    os::unix::fs::{PermissionsExt, symlink},
};

use serde_json::Value;

use crate::mesh_folder::{FAR, SQUARE, code, command, complaint, fix, folder, json, names};

#[test]
fn fix_of_clean_files_writes_them_byte_for_byte() {
    let folder = folder();
    let path = folder.path();
    for (name, out) in [
        ("square.obj", "a.obj"),
        ("far.ply", "a.ply"),
        ("binary.ply", "b.ply"),
        ("clean.glb", "a.glb"),
        ("clean.gltf", "a.gltf"),
    ] {
        let output = fix(&[name, "-o", out, "--json"], path);
        assert_eq!(code(&output), 0, "{name} {output:?}");
        let report = json(&output);
        assert_eq!((&report["clean"], &report["num_iterations"]), (&true.into(), &0.into()));
        assert_eq!((&report["history"], &report["blocked"]), (&serde_json::json!([]), &serde_json::json!([])));
        assert_eq!(report["distortion"]["max_displacement_m"], 0.0);
        assert_eq!(report["distortion"]["max_edge_stretch"], 1.0);
        assert_eq!(fs::read(path.join(out)).unwrap(), fs::read(path.join(name)).unwrap(), "{name}");
    }
    let mode = |name: &str| fs::metadata(path.join(name)).unwrap().permissions().mode();
    assert_eq!(mode("a.obj"), mode("square.obj"), "an output is a file like any other");
    assert!(names(path).iter().all(|name| !name.starts_with('.')), "{:?}", names(path));
}

#[test]
fn fix_of_several_files_writes_one_or_as_many() {
    let folder = folder();
    let path = folder.path();
    assert_eq!(code(&fix(&["square.obj", "far.ply", "-o", "both.obj"], path)), 0);
    let both = fs::read_to_string(path.join("both.obj")).unwrap();
    let far = "\no far\ng default\ns off\nusemtl none\nv 9 0 0.1\nv 9 1 0\nv 9 0 1\nf 5 6 7\n";
    assert_eq!(both, format!("{SQUARE}{far}"));
    assert_eq!(code(&fix(&["far.ply", "square.obj", "-o", "both.ply"], path)), 0);
    assert!(fs::read(path.join("both.ply")).unwrap().starts_with(b"ply\nformat binary_little_endian"));

    fs::create_dir(path.join("out")).unwrap();
    let output = fix(&["square.obj", "far.ply", "clean.glb", "-o", "out", "--json"], path);
    let outputs = ["out/square.obj", "out/far.ply", "out/clean.glb"];
    assert_eq!((code(&output), &json(&output)["outputs"]), (0, &outputs.to_vec().into()));
    for out in outputs {
        let name = out.strip_prefix("out/").unwrap();
        assert_eq!(fs::read(path.join(out)).unwrap(), fs::read(path.join(name)).unwrap(), "{name}");
    }
    // From another folder the buffer of a glTF would not be found: it comes along.
    assert_eq!(code(&fix(&["clean.gltf", "-o", "out/"], path)), 0);
    assert!(fs::read_to_string(path.join("out/clean.gltf")).unwrap().contains("\"uri\": \"data:"));

    fs::create_dir(path.join("more")).unwrap();
    fs::copy(path.join("spike.obj"), path.join("more/FAR.ply")).unwrap();
    fs::write(path.join("more/FAR.ply"), FAR).unwrap();
    fs::remove_file(path.join("out/far.ply")).unwrap();
    let text = complaint(&["far.ply", "more/FAR.ply", "-o", "out"], path);
    assert!(text.contains("out/FAR.ply: would be written twice, from far.ply and from more/FAR.ply"), "{text}");
    let text = complaint(&["far.ply", "clean.glb", "-o", "both.glb"], path);
    assert!(text.contains("both.glb: glTF is only written from one glTF file"), "{text}");
    let text = complaint(&["far.ply", "-o", "a.stl"], path);
    assert!(text.contains("a.stl: STL is only written from one STL file; write .obj or .ply"), "{text}");
    let text = complaint(&["far.ply", "-o", "none/a.ply"], path);
    assert!(text.contains("none/a.ply: there is no folder none"), "{text}");
    let text = complaint(&["far.ply", "-o", "none/"], path);
    assert!(text.contains("none/: there is no such folder"), "{text}");
}

/// The triangles of an OBJ without polygons as ascii STL.
fn stl_of(obj: &str) -> String {
    let numbers = |line: &str| -> Vec<String> { line.split_whitespace().skip(1).map(str::to_owned).collect() };
    let places: Vec<_> = obj.lines().filter(|line| line.starts_with("v ")).map(numbers).collect();
    let mut stl = String::from("solid cloth\n");
    for face in obj.lines().filter(|line| line.starts_with("f ")).map(numbers) {
        let corners = face.iter().map(|corner| places[corner.parse::<usize>().unwrap() - 1][..3].join(" "));
        let corners: Vec<String> = corners.map(|place| format!("vertex {place}\n")).collect();
        stl += &format!("facet normal 0 0 0\nouter loop\n{}endloop\nendfacet\n", corners.concat());
    }
    stl + "endsolid cloth\n"
}

#[test]
fn fix_of_stl_ends_clean_with_whole_sheets_as_that_of_obj() {
    let folder = folder();
    let path = folder.path();
    let mut obj = String::new();
    for (sheet, turn) in [(0, false), (1, true)] {
        for row in 0..6 {
            for column in 0..6 {
                let [u, v] = [column, row].map(|k| f64::from(k) * 0.2 - 0.5);
                let [x, y, z] = if turn { [0.51, u + 0.013, v] } else { [u + 0.31, v, 0.02] };
                obj += &format!("v {x:.3} {y:.3} {z:.3}\n");
                let a = 36 * sheet + 6 * row + column + 1;
                if row < 5 && column < 5 {
                    obj += &format!("f {} {} {}\nf {} {} {}\n", a, a + 1, a + 6, a + 6, a + 1, a + 7);
                }
            }
        }
    }
    fs::write(path.join("sheets.obj"), &obj).unwrap();
    fs::write(path.join("sheets.stl"), stl_of(&obj)).unwrap();
    let reports = ["obj", "stl"].map(|extension| {
        let [name, out] = ["sheets", "out"].map(|stem| format!("{stem}.{extension}"));
        let output = fix(&[&name, "-o", &out, "--json"], path);
        assert_eq!(code(&output), 0, "{output:?}");
        let again = command("check", path).args([&out, "--json"]).output().unwrap();
        assert_eq!(code(&again), 0, "{again:?}");
        json(&command("check", path).args([&name, "--json"]).output().unwrap())
    });
    for key in ["num_vertices", "num_faces", "num_pieces", "num_edge_face_intersections"] {
        assert_eq!(reports[0][key], reports[1][key], "{key}");
        assert!(reports[0][key].as_u64() > Some(0), "{key}");
    }
    let facets = |name: &str| fs::read_to_string(path.join(name)).unwrap().matches("endfacet").count();
    assert_eq!(facets("out.stl"), facets("sheets.stl"));
    // Corners that were in one place are in one place.
    let places = |name: &str| {
        let text = fs::read_to_string(path.join(name)).unwrap();
        let places = text.lines().filter(|line| line.starts_with("vertex")).map(str::to_owned);
        places.collect::<std::collections::BTreeSet<_>>().len()
    };
    assert_eq!(places("out.stl"), places("sheets.stl"));
    assert_eq!(code(&fix(&["sheets.stl", "-o", "as.ply"], path)), 0);
}

#[test]
fn fix_onto_an_existing_output_needs_overwrite() {
    let folder = folder();
    let path = folder.path();
    fs::write(path.join("old.obj"), "old").unwrap();
    fs::set_permissions(path.join("old.obj"), fs::Permissions::from_mode(0o640)).unwrap();
    fs::write(path.join("old.json"), "old").unwrap();
    symlink("old.obj", path.join("link.obj")).unwrap();
    for out in ["old.obj", "link.obj"] {
        let text = complaint(&["square.obj", "-o", out], path);
        assert!(text.contains(&format!("{out}: exists; --overwrite replaces it")), "{text}");
    }
    let text = complaint(&["square.obj", "-o", "a.obj", "--report", "old.json"], path);
    assert!(text.contains("old.json: exists"), "{text}");
    assert_eq!(fs::read(path.join("old.obj")).unwrap(), b"old");
    let output = fix(&["square.obj", "-o", "link.obj", "--report", "old.json", "--overwrite"], path);
    assert_eq!(code(&output), 0, "{output:?}");
    assert_eq!(fs::read(path.join("old.obj")).unwrap(), SQUARE.as_bytes());
    assert!(fs::symlink_metadata(path.join("link.obj")).unwrap().is_symlink());
    assert_eq!(fs::metadata(path.join("old.obj")).unwrap().permissions().mode() & 0o777, 0o640);
    let report: Value = serde_json::from_slice(&fs::read(path.join("old.json")).unwrap()).unwrap();
    assert_eq!(report["schema"], "untangled.fix/1");
    let text = complaint(&["square.obj", "-o", "/dev/null", "--overwrite"], path);
    assert!(text.contains("/dev/null: is not a regular file"), "{text}");
}
