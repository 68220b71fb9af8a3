//! Skins and morph targets: where a mesh is at rest, and whether it can be written there.

use serde_json::{Value, json};

use super::*;

/// Four points on two joints, the first two on the first one; nodes 1 and 2 are the joints, 5 high.
fn skinned() -> (Value, Vec<u8>) {
    let points: [[f32; 3]; 4] = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [1., 1., 0.]];
    let mut bytes: Vec<u8> = points.iter().flatten().flat_map(|value| value.to_le_bytes()).collect();
    bytes.extend([[0, 1, 0, 0]; 4].as_flattened());
    let weights: [[f32; 4]; 4] = [[1., 0., 0., 0.], [1., 0., 0., 0.], [0., 1., 0., 0.], [0.5, 0.5, 0., 0.]];
    bytes.extend(weights.iter().flatten().flat_map(|value| value.to_le_bytes()));
    let mut inverse = [0f32; 16];
    (0..4).for_each(|at| inverse[5 * at] = 1.0);
    inverse[14] = -5.0;
    bytes.extend([inverse; 2].as_flattened().iter().flat_map(|value| value.to_le_bytes()));
    let view = |start: usize, length: usize| json!({"buffer": 0, "byteOffset": start, "byteLength": length});
    let accessor = |view: usize, kind: usize, count: usize, shape: &str| {
        let [min, max] = [[0, 0, 0], [1, 1, 0]];
        json!({"bufferView": view, "componentType": kind, "count": count, "type": shape, "min": min, "max": max})
    };
    let document = json!({
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0, 1, 2]}],
        "nodes": [
            {"mesh": 0, "skin": 0, "translation": [70, 0, 0]},
            {"translation": [0, 0, 5]},
            {"translation": [0, 0, 5]},
        ],
        "skins": [{"joints": [1, 2], "inverseBindMatrices": 3}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "JOINTS_0": 1, "WEIGHTS_0": 2}, "mode": 5}]}],
        "accessors": [accessor(0, 5126, 4, "VEC3"), accessor(1, 5121, 4, "VEC4"), accessor(2, 5126, 4, "VEC4"),
                      accessor(3, 5126, 2, "MAT4")],
        "bufferViews": [view(0, 48), view(48, 16), view(64, 64), view(128, 128)],
        "buffers": [{"byteLength": bytes.len()}],
    });
    (document, bytes)
}

fn read_rest(document: &Value, bytes: &[u8]) -> (Vec<[f64; 3]>, Vec<String>) {
    let (parsed, read) = parse(glb(&document.to_string(), bytes), Path::new("")).unwrap();
    (parsed.positions, read.fixed_vertices().map(|(_, reason)| reason.to_owned()).collect())
}

const PLAIN: [[f64; 3]; 4] = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [1., 1., 0.]];

#[test]
fn mesh_in_the_pose_of_its_binding_is_where_its_joints_are_and_can_be_written() {
    let (mut document, bytes) = skinned();
    // The transform of its own node means nothing.
    assert_eq!(read_rest(&document, &bytes), (PLAIN.to_vec(), vec![]));
    document["nodes"][1]["translation"] = json!([0, 0, 7.000_001]);
    document["nodes"][2]["translation"] = json!([0, 0, 7]);
    let (positions, fixed) = read_rest(&document, &bytes);
    assert!(positions.iter().zip(PLAIN).all(|(a, b)| (a[2] - b[2] - 2.0).abs() < 1e-5 && a[..2] == b[..2]));
    assert!(fixed.is_empty());
    let (parsed, read) = parse(glb(&document.to_string(), &bytes), Path::new("")).unwrap();
    let mut moved = parsed.positions.clone();
    moved[3][2] += 0.25;
    let stored = read.stored_positions(&parsed.positions, &moved).unwrap();
    assert!(stored[..3] == parsed.positions[..3] && (stored[3][2] - moved[3][2]).abs() < 1e-6);
}

#[test]
fn mesh_that_is_posed_is_where_its_joints_move_it_and_stays_as_it_is() {
    let (mut document, bytes) = skinned();
    document["nodes"][2]["translation"] = json!([0, 0, 9]);
    let expected = [[0., 0., 0.], [1., 0., 0.], [0., 1., 4.], [1., 1., 2.]];
    assert_eq!(read_rest(&document, &bytes), (expected.to_vec(), vec!["node 0 is posed by its skin".to_owned()]));
    // Joints that are not in the scene, or none at all: the node's own transform, as the mesh was read before.
    document["scenes"][0]["nodes"] = json!([0, 1]);
    let (positions, fixed) = read_rest(&document, &bytes);
    assert_eq!((positions[1], fixed), ([71., 0., 0.], vec!["node 0 is skinned".to_owned()]));
}

#[test]
fn morph_targets_are_applied_by_the_weights_of_the_document() {
    let (mut document, bytes) = skinned();
    document["nodes"][0] = json!({"mesh": 0});
    let primitive = &mut document["meshes"][0]["primitives"][0];
    primitive["targets"] = json!([{"POSITION": 4}, {"NORMAL": 4}]);
    document["accessors"]
        .as_array_mut()
        .unwrap()
        .push(json!({"bufferView": 2, "componentType": 5126, "count": 4, "type": "VEC3"}));
    // At weights of zero the mesh is its own, and moves with all its targets.
    document["meshes"][0]["weights"] = json!([0, 0]);
    assert_eq!(read_rest(&document, &bytes), (PLAIN.to_vec(), vec![]));
    document["nodes"][0]["weights"] = json!([0.5, 1]);
    let (positions, fixed) = read_rest(&document, &bytes);
    assert_eq!((positions[0], positions[1]), ([0.5, 0., 0.], [1., 0.5, 0.]));
    assert_eq!(fixed, ["mesh 0 is morphed by its weights"]);
}
