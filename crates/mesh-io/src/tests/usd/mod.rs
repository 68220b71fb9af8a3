//! Stages of USD: what is read, composed, written over and refused.
//!
//! `quads.usdc`, `.usda` and `.usdz` were made by usd-core 26.11: two meshes below a transform, half a metre to the
//! unit, points at the time codes 5 to 7, a hole, left-handed faces, texture coordinates.
#![expect(clippy::float_cmp, reason = "what is stored and read is the same number")]

mod compose;
mod damage;
mod refusals;

use std::{fs, path::Path};

use crate::{MeshFile, UsdError, VertexCache};

const QUADS: [(&str, &[u8]); 3] = [
    ("quads.usda", include_bytes!("../data/quads.usda")),
    ("quads.usdc", include_bytes!("../data/quads.usdc")),
    ("quads.usdz", include_bytes!("../data/quads.usdz")),
];

/// A triangle below a prim, one metre to the unit.
const TRIANGLE: &str = "def Mesh \"tri\" {
    int[] faceVertexCounts = [3]
    int[] faceVertexIndices = [0, 1, 2]
    point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
}\n";

/// A text layer of a metre to the unit.
fn layer(metadata: &str, prims: &str) -> String {
    format!("#usda 1.0\n(\n    metersPerUnit = 1\n    {metadata}\n)\n{prims}")
}

/// The mesh and the cache of a prim in the first of some files, all of which are written to a folder.
fn open(folder: &Path, files: &[(&str, &[u8])], prim: &str) -> Result<(MeshFile, VertexCache), UsdError> {
    for (name, bytes) in files {
        fs::write(folder.join(name), bytes).unwrap();
    }
    VertexCache::open_usd(&folder.join(files[0].0), prim)
}

#[test]
fn stages_of_all_formats_give_meshes_in_metres_in_the_world() {
    let folder = tempfile::tempdir().unwrap();
    for file in QUADS {
        let (mesh, cache) = open(folder.path(), &[file], "/world").unwrap();
        assert_eq!(cache.frames(), 5..=7, "{}", file.0);
        assert_eq!(cache.time_code(6), Some(6.0));
        // The ninth face is a hole; the others are turned round.
        assert_eq!(mesh.polygons().len(), 9);
        assert_eq!(mesh.polygons().corners(0), [4, 5, 1, 0]);
        assert_eq!(mesh.polygons().uv_corners(0), None, "the patch has none");
        assert_eq!(mesh.polygons().corners(8), [16, 17, 18]);
        assert_eq!(mesh.part_of_face(0).unwrap().to_string(), "prim \"/world/cloth\"");
        // What UsdGeom.XformCache says of time code 6; the patch is half way there.
        let frame = cache.read(6).unwrap();
        assert_eq!(frame.positions()[..3], [[5.0, 0.0, 0.425], [5.0, 0.5, 0.425], [5.0, 1.0, 0.425]]);
        assert_eq!(frame.positions()[16..], [[5.0, 0.0, 3.05], [5.0, 0.5, 3.05], [4.5, 0.0, 3.05]]);
        let (mesh, _) = open(folder.path(), &[file], "/world/cloth").unwrap();
        assert_eq!((mesh.positions().len(), mesh.polygons().uv_corners(0).unwrap()), (16, &[4, 5, 1, 0][..]));
        assert_eq!(mesh.uv_coordinates()[1], [0.0, f64::from(0.333_333_34_f32)]);
    }
}

#[test]
fn frame_of_a_stage_keeps_the_bits_of_points_that_do_not_move() {
    let folder = tempfile::tempdir().unwrap();
    let (_, cache) = open(folder.path(), &QUADS[1..2], "/world").unwrap();
    let frame = cache.read(7).unwrap();
    let before = frame.encode(frame.positions()).unwrap();
    let mut moved = frame.positions().to_vec();
    moved[2][2] += 0.123_456_789;
    moved[17][0] -= 1e-3;
    let stored = frame.stored_positions(&moved).unwrap();
    let after = frame.encode(&stored).unwrap();
    assert_eq!(after, frame.encode(&moved).unwrap());
    for (vertex, (before, after)) in before.chunks(12).zip(after.chunks(12)).enumerate() {
        assert_eq!(before == after, ![2, 17].contains(&vertex), "{vertex}");
    }
    let back = cache.decode(7, after).unwrap();
    assert_eq!(back.positions(), stored);
    assert_eq!(back.stored_positions(&stored).unwrap(), stored);
    assert!((stored[2][2] - moved[2][2]).abs() < 1e-6);
}

#[test]
fn layer_over_a_stage_says_points_alone_and_brings_in_the_stage() {
    let folder = tempfile::tempdir().unwrap();
    for file in QUADS {
        let (_, cache) = open(folder.path(), &[file], "/world").unwrap();
        let path = folder.path().join("fix.usda");
        // Every point of the cloth up by a quarter, in its own space.
        let mut read = |frame: u64, vertices: std::ops::Range<usize>| {
            let frame = cache.read(frame).unwrap();
            let mut bytes = frame.encode(frame.positions()).unwrap();
            for point in bytes.chunks_mut(12).take(16) {
                let z = f32::from_le_bytes(std::array::from_fn(|byte| point[8 + byte])) + 0.25;
                point[8..].copy_from_slice(&z.to_le_bytes());
            }
            Ok(bytes[12 * vertices.start..12 * vertices.end].to_vec())
        };
        let mut text = Vec::new();
        cache.write_layer(&path, &(5..=7), &mut read, &mut text).unwrap();
        fs::write(&path, &text).unwrap();
        let text = String::from_utf8(text).unwrap();
        let head = format!(
            "#usda 1.0\n(\n    defaultPrim = \"world\"\n    metersPerUnit = 0.5\n    timeCodesPerSecond = 24\n    \
             upAxis = \"Z\"\n    subLayers = [\n        @./{}@\n    ]\n)\n\nover \"world\"\n{{\n\n    \
             over \"cloth\"\n    {{\n        point3f[] points.timeSamples = {{\n            \
             5: [(0, 0, 0.875), (1, 0, 0.875), ",
            file.0
        );
        assert!(text.starts_with(&head), "{text}");
        assert_eq!(text.matches(" = ").count(), 5 + 2, "{text}");
        let (_, above) = VertexCache::open_usd(&path, "/world").unwrap();
        assert_eq!(above.frames(), 5..=7);
        for frame in 5..=7 {
            let [below, above] = [&cache, &above].map(|cache| cache.read(frame).unwrap().positions().to_vec());
            for (vertex, (below, above)) in below.iter().zip(&above).enumerate() {
                let expected = if vertex < 16 { below[2] + 0.125 } else { below[2] };
                assert!((above[2] - expected).abs() < 1e-12 && above[..2] == below[..2], "{vertex}");
            }
        }
    }
}

#[test]
fn stage_without_samples_is_one_frame_and_gets_points_without_samples() {
    let folder = tempfile::tempdir().unwrap();
    let text = layer("", TRIANGLE);
    let (mesh, cache) = open(folder.path(), &[("one.usda", text.as_bytes())], "/tri").unwrap();
    assert_eq!((cache.frames(), cache.time_code(0)), (0..=0, None));
    assert_eq!(mesh.positions()[1], [1.0, 0.0, 0.0]);
    let frame = cache.read(0).unwrap();
    assert!(frame.is_single_precision());
    let bytes = frame.encode(&[[0.0, 0.0, -0.5], [1.0, 0.0, 0.0], [0.0, 1.0, 1e-7]]).unwrap();
    let mut out = Vec::new();
    let mut read = |_, _: std::ops::Range<usize>| Ok(bytes.clone());
    cache.write_layer(&folder.path().join("fix.usda"), &(0..=0), &mut read, &mut out).unwrap();
    let text = String::from_utf8(out).unwrap();
    assert!(
        text.ends_with("over \"tri\"\n{\n    point3f[] points = [(0, 0, -0.5), (1, 0, 0), (0, 1, 1e-7)]\n}\n"),
        "{text}"
    );
}

#[test]
fn frames_have_the_numbers_of_time_codes_only_where_these_are_whole_and_without_a_gap() {
    let folder = tempfile::tempdir().unwrap();
    for (times, frames) in [
        (&["101", "102", "103"][..], 101..=103),
        (&["0"], 0..=0),
        (&["-1", "0", "1"], 0..=2),
        (&["1", "1.5", "2"], 0..=2),
        (&["2", "4"], 0..=1),
        (&["2", "1e0"], 1..=2),
    ] {
        let samples: Vec<String> =
            times.iter().map(|time| format!("{time}: [(0, 0, 0), (1, 0, 0), (0, 1, {time})]")).collect();
        let points = format!("points.timeSamples = {{ {} }} #", samples.join(", "));
        let text = layer("", &TRIANGLE.replace("points =", &points));
        let (_, cache) = open(folder.path(), &[("times.usda", text.as_bytes())], "/tri").unwrap();
        assert_eq!(cache.frames(), frames, "{times:?}");
        for frame in frames {
            assert_eq!(cache.read(frame).unwrap().positions()[2][2], cache.time_code(frame).unwrap());
        }
    }
}
