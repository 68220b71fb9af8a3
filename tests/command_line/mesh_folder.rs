//! A folder of small meshes, and `untangled` run in it.

use std::{
    fs,
    path::Path,
    process::{Command, Output},
};

use serde_json::Value;
use untangled_testkit::{files::formats::glb_file, process::untangled};

pub(crate) fn command(subcommand: &str, folder: &Path) -> Command {
    let mut command = Command::new(untangled());
    command.arg(subcommand).current_dir(folder);
    command
}

pub(crate) fn fix(arguments: &[&str], folder: &Path) -> Output {
    command("fix", folder).args(arguments).output().unwrap()
}

pub(crate) fn code(output: &Output) -> i32 {
    output.status.code().unwrap()
}

pub(crate) fn json(output: &Output) -> Value {
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(errors.lines().all(is_progress), "{output:?}");
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Whether a line on standard error is what a long run says now and then: after how many seconds, and what it does.
pub(crate) fn is_progress(line: &str) -> bool {
    let said = line.strip_prefix("untangled: ").and_then(|line| line.split_once(" s: "));
    said.is_some_and(|(seconds, _)| seconds.parse::<u64>().is_ok())
}

/// What stands on standard error: one line.
pub(crate) fn complaint(arguments: &[&str], folder: &Path) -> String {
    let before = names(folder);
    let output = fix(arguments, folder);
    assert_eq!(code(&output), 2, "{arguments:?} {output:?}");
    assert!(output.stdout.is_empty(), "{output:?}");
    assert_eq!(names(folder), before, "{arguments:?}");
    let text = String::from_utf8(output.stderr.clone()).unwrap();
    assert_eq!(text.trim_end().lines().count(), 1, "{text}");
    text
}

pub(crate) fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

pub(crate) const SQUARE: &str = "# a floor\r\nmtllib cloth.mtl\r\nv 0 0 0\r\nv 1.00 0 1e-2\r\nv 1 1 0 0.5 0.5 0.5\r\nv \
                                 0 1 0.02\r\nvn 0 0 1\r\nvt 0 0\r\nvt 1 0\r\nvt 1 1\r\nvt 0 1\r\ng floor\r\nusemtl \
                                 red\r\ns 1\r\nf 1/1/1 2/2/1 3/3/1 4/4/1\r\nl 1 2\r\n# end";
pub(crate) const SPIKE: &str = "v 0.2 0.1 -1\nv 0.3 0.25 1\nv 0.25 0.4 -1\nusemtl blue\nf -3 -2 -1\n";
pub(crate) const FAR: &str = "ply\nformat ascii 1.0\ncomment far away\nelement vertex 3\nproperty float x\nproperty \
                              float y\nproperty float z\nelement face 1\nproperty list uchar int \
                              vertex_indices\nend_header\n9 0 0.1\n9 1 0\n9 0 1\n3 0 1 2\n";

/// A triangle as binary PLY.
fn binary_ply() -> Vec<u8> {
    let mut bytes = b"ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty double x\nproperty double \
                      y\nproperty double z\nproperty uchar red\nelement face 1\nproperty list uchar int \
                      vertex_indices\nend_header\n"
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
        "nodes": [{{"mesh": 0, "scale": [2, 2, 2], "name": "both"}}],
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}, "indices": 1}}]}}],
        "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 7, "type": "VEC3",
                "min": [0, 0, {}], "max": [1, 1, 2]}},
            {{"bufferView": 1, "componentType": 5123, "count": 9, "type": "SCALAR"}}],
        "bufferViews": [{{"buffer": 0, "byteLength": 84}}, {{"buffer": 0, "byteOffset": 84, "byteLength": 18}}],
        "buffers": [{{{link}"byteLength": 102}}], "extras": {{"kept":  [1,2 , 3]}} }}"#,
        tip.min(0.0)
    );
    (json, bytes)
}

fn glb(tip: f32) -> Vec<u8> {
    let (json, bytes) = gltf(None, tip);
    glb_file(json.into_bytes(), bytes)
}

/// A folder with the files above.
pub(crate) fn folder() -> tempfile::TempDir {
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
