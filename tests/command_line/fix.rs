//! `untangled fix` as a user or a script runs it.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::{
    ffi::OsStr,
    fs,
    io::Write,
    os::unix::{
        ffi::OsStrExt,
        fs::{PermissionsExt, symlink},
    },
    path::Path,
    process::{Command, Output, Stdio},
};

use rustix::{
    fs::{CWD, FileType, Mode, mknodat},
    process::{Pid, Signal, kill_process},
};
use serde_json::Value;

fn command(subcommand: &str, folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_untangled"));
    command.arg(subcommand).current_dir(folder);
    command
}

fn fix(arguments: &[&str], folder: &Path) -> Output {
    command("fix", folder).args(arguments).output().unwrap()
}

fn code(output: &Output) -> i32 {
    output.status.code().unwrap()
}

fn json(output: &Output) -> Value {
    assert!(output.stderr.is_empty(), "{output:?}");
    serde_json::from_slice(&output.stdout).unwrap()
}

/// What stands on standard error: one line.
fn complaint(arguments: &[&str], folder: &Path) -> String {
    let before = names(folder);
    let output = fix(arguments, folder);
    assert_eq!(code(&output), 2, "{arguments:?} {output:?}");
    assert!(output.stdout.is_empty(), "{output:?}");
    assert_eq!(names(folder), before, "{arguments:?}");
    let text = String::from_utf8(output.stderr.clone()).unwrap();
    assert_eq!(text.trim_end().lines().count(), 1, "{text}");
    text
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

const SQUARE: &str = "# a floor\r\nmtllib cloth.mtl\r\nv 0 0 0\r\nv 1.00 0 1e-2\r\nv 1 1 0 0.5 0.5 0.5\r\nv 0 1 0.02\r\nvn 0 0 1\r\nvt 0 0\r\n\
vt 1 0\r\nvt 1 1\r\nvt 0 1\r\ng floor\r\nusemtl red\r\ns 1\r\nf 1/1/1 2/2/1 3/3/1 4/4/1\r\nl 1 2\r\n# end";
const SPIKE: &str = "v 0.2 0.1 -1\nv 0.3 0.25 1\nv 0.25 0.4 -1\nusemtl blue\nf -3 -2 -1\n";
const FAR: &str = "ply\nformat ascii 1.0\ncomment far away\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
element face 1\nproperty list uchar int vertex_indices\nend_header\n9 0 0.1\n9 1 0\n9 0 1\n3 0 1 2\n";

/// A triangle as binary PLY.
fn binary_ply() -> Vec<u8> {
    let mut bytes = b"ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n\
property uchar red\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
        .to_vec();
    for point in [[0.1, 0.0, 0.0f64], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] {
        bytes.extend(point.iter().flat_map(|value| value.to_be_bytes()));
        bytes.push(255);
    }
    bytes.extend([3, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 2]);
    bytes
}

/// A square that a triangle pierces, as glTF with its buffer as a link, or as GLB.
fn gltf(link: Option<&str>, tip: f32) -> (String, Vec<u8>) {
    let points =
        [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.], [0.2, 0.1, 2.0], [0.3, 0.25, tip], [0.25, 0.4, 2.0]];
    let mut bytes: Vec<u8> = points.iter().flatten().flat_map(|value: &f32| value.to_le_bytes()).collect();
    bytes.extend([0u16, 1, 2, 0, 2, 3, 4, 5, 6].iter().flat_map(|index| index.to_le_bytes()));
    let link = link.map_or(String::new(), |link| format!(r#""uri": "{link}", "#));
    let json = format!(
        r#"{{ "asset": {{"version": "2.0", "generator": "a test"}}, "scene": 0, "scenes": [{{"nodes": [0]}}],
        "nodes": [{{"mesh": 0, "scale": [2, 2, 2], "name": "both"}}], "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}, "indices": 1}}]}}],
        "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 7, "type": "VEC3", "min": [0, 0, {}], "max": [1, 1, 2]}},
            {{"bufferView": 1, "componentType": 5123, "count": 9, "type": "SCALAR"}}],
        "bufferViews": [{{"buffer": 0, "byteLength": 84}}, {{"buffer": 0, "byteOffset": 84, "byteLength": 18}}],
        "buffers": [{{{link}"byteLength": 102}}], "extras": {{"kept":  [1,2 , 3]}} }}"#,
        tip.min(0.0)
    );
    (json, bytes)
}

fn glb(tip: f32) -> Vec<u8> {
    let (json, mut bytes) = gltf(None, tip);
    let mut json = json.into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    bytes.resize(bytes.len().next_multiple_of(4), 0);
    let word = |value: usize| u32::try_from(value).unwrap().to_le_bytes();
    let mut file = b"glTF\x02\0\0\0".to_vec();
    file.extend(word(12 + 8 + json.len() + 8 + bytes.len()));
    for (kind, data) in [(b"JSON", json), (b"BIN\0", bytes)] {
        file.extend(word(data.len()));
        file.extend(kind);
        file.extend(data);
    }
    file
}

/// A folder with the files above.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: &[u8]| fs::write(folder.path().join(name), bytes).unwrap();
    write("square.obj", SQUARE.as_bytes());
    write("spike.obj", SPIKE.as_bytes());
    write("far.ply", FAR.as_bytes());
    write("binary.ply", &binary_ply());
    write("clean.glb", &glb(1.0));
    write("tangled.glb", &glb(-1.0));
    let (json, bytes) = gltf(Some("cloth.bin"), 1.0);
    write("clean.gltf", json.as_bytes());
    write("cloth.bin", &bytes);
    folder
}

#[test]
fn clean_files_come_out_byte_for_byte() {
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
fn several_files_become_one_or_as_many() {
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
fn inputs_are_never_overwritten() {
    let folder = folder();
    let path = folder.path();
    fs::create_dir(path.join("sub")).unwrap();
    symlink(path.join("square.obj"), path.join("link.obj")).unwrap();
    symlink("nowhere.obj", path.join("dangling.obj")).unwrap();
    symlink(path, path.join("sub/up")).unwrap();
    fs::hard_link(path.join("square.obj"), path.join("hard.obj")).unwrap();
    fs::write(path.join("pins.txt"), "0 # the first\n").unwrap();
    let absolute = path.join("square.obj");
    let absolute = absolute.to_str().unwrap();
    let spellings = [
        "square.obj",
        "./square.obj",
        "sub/../square.obj",
        absolute,
        "link.obj",
        "hard.obj",
        "sub/up/square.obj",
        ".",
        "sub/up",
    ];
    for out in spellings {
        for more in [&[][..], &["--overwrite"]] {
            let arguments = [&["square.obj", "-o", out][..], more].concat();
            let text = complaint(&arguments, path);
            assert!(text.contains("is an input, and inputs are never overwritten"), "{text}");
        }
    }
    // Nor is what an input brings along, nor anything by the report.
    fs::hard_link(path.join("cloth.bin"), path.join("bin.gltf")).unwrap();
    for arguments in [
        &["clean.gltf", "-o", "bin.gltf", "--overwrite"][..],
        &["square.obj", "-o", "a.obj", "--report", "hard.obj", "--overwrite"],
        &["square.obj", "-o", "a.obj", "--pin", "pins.txt", "--report", "pins.txt", "--overwrite"],
        &["square.obj", "--pin", "pins.txt", "-o", "pins.txt", "--overwrite"],
    ] {
        let text = complaint(arguments, path);
        assert!(text.contains("is an input"), "{text}");
    }
    let text = complaint(&["square.obj", "-o", "a.obj", "--report", "sub/../a.obj"], path);
    assert!(text.contains("can't be the report as well"), "{text}");
    let text = complaint(&["square.obj", "-o", "dangling.obj", "--overwrite"], path);
    assert!(text.contains("dangling.obj: is a link that leads nowhere"), "{text}");
    assert_eq!(fs::read(path.join("square.obj")).unwrap(), SQUARE.as_bytes());
}

#[test]
fn outputs_are_replaced_only_if_that_is_asked_for() {
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

#[test]
fn the_report_has_every_field_of_the_contract() {
    let folder = folder();
    let path = folder.path();
    for (inputs, out) in [(&["square.obj", "spike.obj"][..], "out.obj"), (&["tangled.glb"], "out.glb")] {
        let output = fix(&[inputs, &["-o", out, "--json", "--report", "report.json", "--overwrite"]].concat(), path);
        let report = json(&output);
        assert_eq!(fs::read(path.join("report.json")).unwrap(), output.stdout);
        assert_eq!(report["schema"], "untangled.fix/1");
        assert!(report["num_iterations"].is_u64() && report["seconds"].is_f64());
        for state in ["before", "after"] {
            let state = &report[state];
            assert!(state["num_edge_face_intersections"].is_u64() && state["num_face_pairs"].is_u64());
            assert!(state["path_pairs"].is_object());
        }
        assert!(report["before"]["num_face_pairs"].as_u64().unwrap() > 0);
        for field in ["max_displacement_m", "mean_displacement_m", "max_edge_stretch", "mean_edge_stretch"] {
            assert!(report["distortion"][field].is_f64(), "{field}");
        }
        for blocked in report["blocked"].as_array().unwrap() {
            assert!(blocked["pair_type"].is_string() && blocked["vertex"].is_u64() && blocked["length_m"].is_f64());
            assert!(!blocked["reason"].as_str().unwrap().is_empty());
        }
        let history = report["history"].as_array().unwrap();
        assert_eq!(history.len() as u64, report["num_iterations"].as_u64().unwrap());
        for iteration in history {
            assert!(iteration["num_edge_face_intersections"].is_u64() && iteration["path_length_m"].is_f64());
            assert!(iteration["method"].is_string());
        }
        // What is said of the output is what another look at it finds.
        let clean = report["clean"].as_bool().unwrap();
        assert_eq!(code(&output), i32::from(!clean));
        assert_eq!(report["blocked"].as_array().unwrap().is_empty(), clean);
        let check = command("check", path).args([out, "--json"]).output().unwrap();
        assert_eq!(code(&check), i32::from(!clean));
        let check: Value = serde_json::from_slice(&check.stdout).unwrap();
        for field in ["num_edge_face_intersections", "num_face_pairs", "path_pairs"] {
            assert_eq!(check[field], report["after"][field], "{field}");
        }
    }
    // What is not geometry is as it was.
    let out = fs::read(path.join("out.glb")).unwrap();
    assert!(out.windows(25).any(|bytes| bytes == br#""extras": {"kept":  [1,2 "#), "{out:?}");
    let out = fs::read_to_string(path.join("out.obj")).unwrap();
    assert!(
        out.contains("usemtl red\r\ns 1\r\nf 1/1/1 2/2/1 3/3/1 4/4/1\r\nl 1 2\r\n# end\no spike\ng default\ns off\nv "),
        "{out}"
    );
    assert!(out.ends_with("usemtl blue\nf -3 -2 -1\n"), "{out}");
    let lines = fix(&["square.obj", "spike.obj", "-o", "lines.obj"], path);
    let lines = String::from_utf8(lines.stdout).unwrap();
    assert!(lines.starts_with("square.obj, spike.obj -> lines.obj\n"), "{lines}");
}

#[test]
fn names_need_not_be_text() {
    let folder = folder();
    let name = OsStr::from_bytes(b"caf\xe9.obj");
    fs::copy(folder.path().join("square.obj"), folder.path().join(name)).unwrap();
    fs::create_dir(folder.path().join("out")).unwrap();
    for subcommand in ["check", "fix"] {
        let mut command = command(subcommand, folder.path());
        command.arg(name).arg("--json");
        if subcommand == "fix" {
            command.args(["-o", "out"]);
        }
        let output = command.output().unwrap();
        assert_eq!((code(&output), &json(&output)["files"]), (0, &serde_json::json!(["caf\u{fffd}.obj"])));
    }
    assert_eq!(fs::read(folder.path().join("out").join(name)).unwrap(), SQUARE.as_bytes());
}

#[test]
fn pins_stay() {
    let folder = folder();
    let path = folder.path();
    let pin = |text: &str| fs::write(path.join("pins.txt"), text).unwrap();
    pin("# all but one\n0 1\t2 3# and the spike\r\n 4 5\n6\n");
    let run = ["square.obj", "spike.obj", "-o", "out", "--pin", "pins.txt", "--json"];
    fs::create_dir(path.join("out")).unwrap();
    let output = fix(&run, path);
    assert_eq!((code(&output), &json(&output)["clean"]), (1, &false.into()));
    assert_eq!(fs::read(path.join("out/square.obj")).unwrap(), SQUARE.as_bytes());
    assert_eq!(fs::read(path.join("out/spike.obj")).unwrap(), SPIKE.as_bytes());
    fs::remove_dir_all(path.join("out")).unwrap();
    fs::create_dir(path.join("out")).unwrap();
    for (text, expected) in [
        ("0\n\n1 x", "pins.txt:3: `x` where a vertex index is needed"),
        ("-1", "pins.txt:1: `-1` where a vertex index is needed"),
        ("1.0", "pins.txt:1: `1.0` where a vertex index is needed"),
        ("# 9\n3\n7", "pins.txt:3: vertex 7 does not exist, there are vertices 0 to 6"),
        ("99999999999999", "pins.txt:1: vertex 99999999999999 does not exist"),
    ] {
        pin(text);
        let text = complaint(&run, path);
        assert!(text.contains(expected), "{text}");
    }
    let text = complaint(&["square.obj", "-o", "a.obj", "--pin", "none.txt"], path);
    assert!(text.contains("none.txt: can't be read: "), "{text}");
}

#[test]
fn bad_input_is_one_line_that_names_it() {
    let folder = folder();
    let path = folder.path();
    let write = |name: &str, text: &str| fs::write(path.join(name), text).unwrap();
    write("short.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n\nf 1 2 900\n");
    write("huge.obj", "v 0 0 0\nv 1 1e200 0\nv 0 1 0\nf 1 2 3\n");
    write("points.obj", "v 0 0 0\n");
    write("empty.obj", "");
    for (name, expected) in [
        ("short.obj", "short.obj:5: face 1 refers to vertex 900, but only 3 are defined"),
        ("huge.obj", "huge.obj:2: vertex 2 has coordinate y"),
        ("points.obj", "points.obj: no mesh in it: 1 vertices, 0 faces"),
        ("empty.obj", "empty.obj: no mesh in it: 0 vertices, 0 faces"),
        ("missing.obj", "missing.obj: can't be read: "),
    ] {
        let text = complaint(&["square.obj", name, "-o", "out.obj", "--json"], path);
        assert!(text.contains(expected), "{text}");
    }
    for usage in [&["-o", "a.obj"][..], &["square.obj"], &["square.obj", "-o", "a.obj", "--quality", "best"]] {
        assert_eq!(code(&fix(usage, path)), 2);
    }
}

#[test]
fn an_interruption_leaves_nothing() {
    for signal in [Signal::INT, Signal::TERM] {
        let folder = folder();
        let path = folder.path();
        // A pipe as the input: when it is open at both ends, the process listens to signals and waits for the mesh.
        mknodat(CWD, path.join("pipe.obj"), FileType::Fifo, Mode::RUSR | Mode::WUSR, 0).unwrap();
        let before = names(path);
        let child = command("fix", path)
            .args(["pipe.obj", "spike.obj", "-o", "out.obj", "--report", "report.json"])
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut pipe = fs::OpenOptions::new().write(true).open(path.join("pipe.obj")).unwrap();
        kill_process(Pid::from_child(&child), signal).unwrap();
        pipe.write_all(SQUARE.as_bytes()).unwrap();
        drop(pipe);
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{output:?}");
        assert_eq!(String::from_utf8_lossy(&output.stderr), "untangled: interrupted; nothing was written\n");
        assert!(output.stdout.is_empty());
        assert_eq!(names(path), before);
    }
}
