//! `untangled fix`: which files it writes, and with which bytes.

use std::{
    fs,
    os::unix::fs::{PermissionsExt, symlink},
};

use serde_json::Value;

use crate::mesh_folder::{FAR, SQUARE, code, complaint, fix, folder, json, names};

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
    assert!(text.contains("a.stl: meshes are written as .obj, .ply, .gltf or .glb"), "{text}");
    let text = complaint(&["far.ply", "-o", "none/a.ply"], path);
    assert!(text.contains("none/a.ply: there is no folder none"), "{text}");
    let text = complaint(&["far.ply", "-o", "none/"], path);
    assert!(text.contains("none/: there is no such folder"), "{text}");
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
