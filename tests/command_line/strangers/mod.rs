//! `untangled` on files that attack it, and on files that others refuse.

use std::{fs, path::Path};

use untangled_mesh_io::read_mesh;
use untangled_testkit::files::shared;

use crate::mesh_folder::{code, command, complaint, folder};

/// A triangle that a link leads to.
fn linking(uri: &str, length: usize) -> String {
    format!(
        r#"{{"asset": {{"version": "2.0"}}, "nodes": [{{"mesh": 0}}],
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}}}]}}],
        "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}}],
        "bufferViews": [{{"buffer": 0, "byteLength": 36}}],
        "buffers": [{{"byteLength": {length}, "uri": "{uri}"}}]}}"#
    )
}

/// Checks that `check` and `fix` refuse a file in words, and that `fix` writes nothing.
fn assert_refused(folder: &Path, file: &Path, words: &str) {
    let name = file.to_str().unwrap();
    let output = command("check", folder).arg(file).output().unwrap();
    let text = String::from_utf8(output.stderr.clone()).unwrap();
    assert_eq!(code(&output), 2, "{text}");
    assert!(text.contains(words) && text.trim_end().lines().count() == 1, "{text}");
    let text = complaint(&[name, "-o", "stolen.gltf"], folder);
    assert!(text.contains(words), "{text}");
    assert!(!folder.join("stolen.gltf").exists());
}

#[test]
fn check_and_fix_of_links_to_foreign_files_are_refused() {
    let folder = folder();
    let path = folder.path();
    fs::create_dir(path.join("model")).unwrap();
    fs::write(path.join("secret"), [0; 64]).unwrap();
    std::os::unix::fs::symlink("../secret", path.join("model/link")).unwrap();
    for link in ["/etc/passwd", "../secret", "%2e%2e/secret", "link", "/dev/zero", ".hidden"] {
        let file = path.join("model/a.gltf");
        fs::write(&file, linking(link, 36)).unwrap();
        assert_refused(path, &file, "only files in the folder of the document are read");
    }
}

#[test]
fn messages_about_names_in_files_escape_control_characters() {
    let folder = folder();
    let evil = "\x1b]0;owned\x07\x1b[2J";
    fs::write(folder.path().join("a.gltf"), linking(&evil.replace('\x1b', "\\u001b").replace('\x07', "\\u0007"), 36))
        .unwrap();
    fs::write(folder.path().join("a.ply"), format!("ply\nformat ascii 1.0\nelement {evil} 3\nend_header\n")).unwrap();
    fs::write(folder.path().join("a.obj"), format!("v 0 0 {evil}\nf 1 1 1\n")).unwrap();
    let named = format!("{evil}.obj");
    fs::write(folder.path().join(&named), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    for file in ["a.gltf", "a.ply", "a.obj", named.as_str()] {
        let output = command("check", folder.path()).arg(file).output().unwrap();
        let text = [output.stdout, output.stderr].concat();
        assert!(text.iter().all(|byte| *byte == b'\n' || !byte.is_ascii_control()), "{text:?}");
    }
}

#[test]
fn check_and_fix_of_shared_attacks_are_refused() {
    let Some(cases) = shared("cases/made") else { return };
    let folder = folder();
    for (name, words) in [
        ("passwd.gltf", "only files in the folder of the document are read"),
        ("exfil.gltf", "only files in the folder of the document are read"),
        ("devzero.gltf", "only files in the folder of the document are read"),
        ("amp_small.gltf", "asks for more mesh than its 621 bytes may"),
        ("amp_nodes10.gltf", "asks for more mesh than its 765 bytes may"),
        ("draco.glb", "Draco-compressed meshes are not read; export the model without compression"),
        ("glb_no_bytelength.glb", "not a valid glTF document: missing field `byteLength`"),
    ] {
        assert_refused(folder.path(), &cases.join(name), words);
    }
}

#[test]
fn fix_of_shared_odd_files_writes_what_it_means_or_refuses() {
    let Some(cases) = shared("cases/made") else { return };
    let folder = folder();
    for (name, words) in [
        ("quant.glb", "accessor 0 is quantised; write .obj or .ply"),
        ("skinned_pinned.gltf", "node 1 is skinned"),
        ("instanced_pinned.gltf", "mesh 1 is used by more than one node"),
        ("sparse_alias.gltf", "accessor 0 shares bytes with the sparse elements of accessor 2"),
    ] {
        let file = cases.join(name);
        assert!(read_mesh(&file).is_ok(), "{name}");
        let text = complaint(&[file.to_str().unwrap(), "-o", &format!("fixed_{name}")], folder.path());
        assert!(text.contains(words), "{text}");
    }
    for name in
        ["req_KHR_texture_basisu.gltf", "two_vertex_elements.ply", "two_vertex_elements_bin.ply", "o2.ply", "o3.ply"]
    {
        let out = folder.path().join(name);
        let output = command("fix", folder.path()).arg(cases.join(name)).arg("-o").arg(&out).output().unwrap();
        assert_eq!(code(&output), 0, "{name}: {output:?}");
        let [before, after] = [cases.join(name), out].map(|path| read_mesh(path).unwrap());
        assert_eq!(before.faces(), after.faces(), "{name}");
        // Nothing moves farther than the mesh is large: a garbled coordinate does.
        let far = before.positions().iter().flatten().fold(1.0f64, |far, x| far.max(x.abs()));
        assert!(after.positions().iter().flatten().all(|x| x.abs() <= 3.0 * far), "{name}");
    }
    // The pinned mesh of several nodes stays, the other one comes out of it.
    for (name, num_vertices) in [("skinned_pinned.gltf", 202), ("instanced_pinned.gltf", 323)] {
        let pins: Vec<String> = (81..num_vertices).map(|vertex: usize| vertex.to_string()).collect();
        fs::write(folder.path().join("pins.txt"), pins.join(" ")).unwrap();
        let out = folder.path().join(name);
        let mut command = command("fix", folder.path());
        let output = command.arg(cases.join(name)).args(["--pin", "pins.txt", "-o"]).arg(&out).output().unwrap();
        assert_eq!(code(&output), 0, "{name}: {output:?}");
        let [before, after] = [cases.join(name), out].map(|path| read_mesh(path).unwrap());
        assert_eq!(before.positions()[81..], after.positions()[81..], "{name}");
        assert_ne!(before.positions()[..81], after.positions()[..81], "{name}");
    }
}
