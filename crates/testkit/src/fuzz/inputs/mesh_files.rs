//! Mesh files that are valid more often than not.

use base64::{Engine, engine::general_purpose::STANDARD};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use serde_json::{Value, json};

use super::grid::grid;
use crate::files::formats::glb_file;

fn number(rng: &mut ChaCha8Rng) -> String {
    match rng.random_range(0..20) {
        0 => format!("{}", f64::from_bits(rng.random())),
        1 => format!("{:e}", rng.random_range(-1e9..1e9)),
        _ => format!("{:.3}", rng.random_range(-1.0..1.0)),
    }
}

/// OBJ text.
pub(in crate::fuzz) fn obj(rng: &mut ChaCha8Rng) -> Vec<u8> {
    let n = rng.random_range(1..4u32);
    let mut text = String::from("# a sheet\nmtllib a.mtl\no sheet\n");
    for _ in 0..(n + 1) * (n + 1) {
        text += &format!("v {} {} {}\n", number(rng), number(rng), number(rng));
    }
    if rng.random() {
        text += "vt 0 0\nvt 1 0\nvt 0 1\n";
    }
    for face in grid(n) {
        let corners = face.map(|corner| match rng.random_range(0..8) {
            0 => format!("{}/1", corner + 1),
            1 => format!("-{}", (n + 1) * (n + 1) - corner),
            2 => format!("{}//1", corner + 1),
            _ => format!("{}", corner + 1),
        });
        text += &format!("f {}{}\n", corners.join(" "), if rng.random_bool(0.1) { " 1" } else { "" });
    }
    text.into_bytes()
}

/// PLY, as text or binary, in either byte order and precision.
pub(in crate::fuzz) fn ply(rng: &mut ChaCha8Rng) -> Vec<u8> {
    let n = rng.random_range(1..4u32);
    let faces = grid(n);
    let (kind, big) =
        [("ascii", false), ("binary_little_endian", false), ("binary_big_endian", true)][rng.random_range(0..3)];
    // The vertices may stand in two elements of different types.
    let num_vertices = (n + 1) * (n + 1);
    let cut = if rng.random_bool(0.2) { rng.random_range(0..=num_vertices) } else { num_vertices };
    let (first, second) = (rng.random::<bool>(), rng.random::<bool>());
    let element = |count: u32, double: bool| {
        let float = if double { "double" } else { "float" };
        format!("element vertex {count}\nproperty {float} x\nproperty {float} y\nproperty {float} z\n")
    };
    let second_element = if cut < num_vertices { element(num_vertices - cut, second) } else { String::new() };
    let mut bytes = format!(
        "ply\nformat {kind} 1.0\ncomment a sheet\n{}{second_element}element face {}\nproperty list uchar int \
         vertex_indices\nend_header\n",
        element(cut, first),
        faces.len()
    )
    .into_bytes();
    for vertex in 0..num_vertices {
        let double = if vertex < cut { first } else { second };
        if kind == "ascii" {
            bytes.extend(format!("{} {} {}\n", number(rng), number(rng), number(rng)).into_bytes());
        } else {
            for _ in 0..3 {
                let value: f64 = number(rng).parse().unwrap_or(0.0);
                let mut word =
                    if double { value.to_le_bytes().to_vec() } else { (value as f32).to_le_bytes().to_vec() };
                if big {
                    word.reverse();
                }
                bytes.extend(word);
            }
        }
    }
    for face in faces {
        if kind == "ascii" {
            bytes.extend(format!("3 {} {} {}\n", face[0], face[1], face[2]).into_bytes());
        } else {
            bytes.push(3);
            bytes.extend(face.iter().flat_map(|i| if big { i.to_be_bytes() } else { i.to_le_bytes() }));
        }
    }
    bytes
}

/// STL, as text or binary; some corners of one vertex are in other places, some facets have no area.
pub(in crate::fuzz) fn stl(rng: &mut ChaCha8Rng) -> Vec<u8> {
    let n = rng.random_range(1..4u32);
    let places: Vec<[String; 3]> = (0..(n + 1) * (n + 1)).map(|_| std::array::from_fn(|_| number(rng))).collect();
    let mut facets: Vec<[[String; 3]; 3]> =
        grid(n).into_iter().map(|face| face.map(|corner| places[corner as usize].clone())).collect();
    for corner in facets.as_flattened_mut() {
        match rng.random_range(0..30) {
            0 => corner[0] = number(rng),
            1 => *corner = places[0].clone(),
            _ => {}
        }
    }
    if rng.random() {
        let mut text = String::from("solid a sheet\n");
        for facet in facets {
            let corners = facet.map(|place| format!("  vertex {}\n", place.join(" "))).concat();
            text += &format!("facet normal 0 0 {}\nouter loop\n{corners}endloop\nendfacet\n", rng.random_range(0..2));
        }
        return (text + "endsolid\n").into_bytes();
    }
    let mut bytes = vec![b's'; 80];
    bytes.extend((facets.len() as u32).to_le_bytes());
    for facet in facets {
        for value in [0.0, 0.0, f32::from(rng.random::<bool>())] {
            bytes.extend(value.to_le_bytes());
        }
        for coordinate in facet.as_flattened() {
            bytes.extend(coordinate.parse().unwrap_or(0.0f32).to_le_bytes());
        }
        bytes.extend([0, 0]);
    }
    bytes
}

/// glTF with its buffer in the document, or GLB.
pub(in crate::fuzz) fn gltf(rng: &mut ChaCha8Rng, binary: bool) -> Vec<u8> {
    let n = rng.random_range(1..3u32);
    let (num_vertices, faces) = ((n + 1) * (n + 1), grid(n));
    let mut data: Vec<u8> = Vec::new();
    for _ in 0..num_vertices * 3 {
        data.extend(number(rng).parse().unwrap_or(0.0f32).to_le_bytes());
    }
    let positions = data.len();
    data.extend(faces.iter().flatten().flat_map(|i| i.to_le_bytes()));
    let mut document = json!({
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "buffers": [{"byteLength": data.len()}],
        "bufferViews": [
            {"buffer": 0, "byteLength": positions},
            {"buffer": 0, "byteOffset": positions, "byteLength": data.len() - positions},
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": num_vertices, "type": "VEC3",
             "min": [-1, -1, -1], "max": [1, 1, 1]},
            {"bufferView": 1, "componentType": 5125, "count": 3 * faces.len(), "type": "SCALAR"},
        ],
    });
    vary(rng, &mut document, num_vertices);
    if binary {
        return glb_file(document.to_string().into_bytes(), data);
    }
    document["buffers"][0]["uri"] = format!("data:application/octet-stream;base64,{}", STANDARD.encode(&data)).into();
    document.to_string().into_bytes()
}

/// Adds what documents may have besides: other nodes with the same mesh, names, a strip, a sparse accessor.
fn vary(rng: &mut ChaCha8Rng, document: &mut Value, num_vertices: u32) {
    if rng.random_bool(0.2) {
        document["nodes"] = json!([{"mesh": 0, "name": "left", "children": [1], "scale": [2, 1, 1]},
                                   {"mesh": 0, "rotation": [0, 0.6, 0, 0.8], "translation": [1, 2, 3]}]);
    } else if rng.random_bool(0.3) {
        document["nodes"][0]["matrix"] = json!([0.5, 0, 0, 0, 0, 2, 0, 0, 0, 0.3, 1, 0, 4, 5, 6, 1]);
    }
    if rng.random_bool(0.2) {
        document["meshes"][0]["primitives"][0]["mode"] = rng.random_range(4..7).into();
    }
    if rng.random_bool(0.2) {
        let sparse = json!({"componentType": 5126, "count": num_vertices, "type": "VEC3", "sparse": {"count": 1,
            "indices": {"bufferView": 1, "componentType": 5121}, "values": {"bufferView": 0}}});
        document["accessors"].as_array_mut().expect("it is a list").push(sparse);
        let primitive = json!({"attributes": {"POSITION": 2}, "indices": 1});
        document["meshes"][0]["primitives"].as_array_mut().expect("it is a list").push(primitive);
    }
    if rng.random_bool(0.1) {
        document["extensionsRequired"] = json!(["KHR_texture_basisu"]);
    }
}
