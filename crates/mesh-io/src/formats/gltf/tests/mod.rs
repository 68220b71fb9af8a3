//! glTF documents as text: read and refused.

mod rest;
mod written;

use std::path::Path;

use super::{container::Chunks, parse};
use crate::{MeshFile, Output, read_mesh};

/// Two primitives over one list of four points, under a node that moves by (10, 0, 0) and whose parent scales by 2.
fn document(stride: u32, indices: &str, buffer_length: usize) -> String {
    format!(
        r#"{{
        "asset": {{"version": "2.0"}}, "scene": 0, "scenes": [{{"nodes": [0]}}],
        "nodes": [{{"scale": [2, 2, 2], "children": [1]}}, {{"translation": [10, 0, 0], "mesh": 0}}],
        "meshes": [{{"primitives": [
            {{"attributes": {{"POSITION": 0}}, "indices": 1}},
            {{"attributes": {{"POSITION": 0}}, "mode": 5}}
        ]}}],
        "accessors": [
            {{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}},
            {indices}
        ],
        "bufferViews": [
            {{"buffer": 0, "byteLength": 48, "byteStride": {stride}}},
            {{"buffer": 0, "byteOffset": 48, "byteLength": 6}}
        ],
        "buffers": [{{"byteLength": {buffer_length}}}]
    }}"#
    )
}

const INDICES: &str = r#"{"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"}"#;

fn glb(json: &str, bytes: &[u8]) -> Vec<u8> {
    let mut json = json.as_bytes().to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut bin = bytes.to_vec();
    bin.resize(bin.len().next_multiple_of(4), 0);
    let word = |value: usize| u32::try_from(value).unwrap().to_le_bytes();
    let mut file = b"glTF\x02\0\0\0".to_vec();
    file.extend(word(12 + 8 + json.len() + 8 + bin.len()));
    file.extend(word(json.len()));
    file.extend(b"JSON");
    file.extend(&json);
    file.extend(word(bin.len()));
    file.extend(b"BIN\0");
    file.extend(&bin);
    file
}

fn buffer(indices: [u16; 3]) -> Vec<u8> {
    let points: [[f32; 3]; 4] = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [1., 1., 0.]];
    let mut bytes: Vec<u8> = points.iter().flatten().flat_map(|value| value.to_le_bytes()).collect();
    bytes.extend(indices.iter().flat_map(|index| index.to_le_bytes()));
    bytes
}

#[test]
fn parse_applies_nodes_and_shares_the_vertices_of_an_accessor() {
    let (parsed, _) = parse(glb(&document(12, INDICES, 54), &buffer([0, 1, 2])), Path::new("")).unwrap();
    assert_eq!(parsed.positions, [[20., 0., 0.], [22., 0., 0.], [20., 2., 0.], [22., 2., 0.]]);
    let faces: Vec<&[u32]> = (0..parsed.polygons.len()).map(|face| parsed.polygons.corners(face)).collect();
    assert_eq!(faces, [[0, 1, 2], [0, 1, 2], [2, 1, 3]]);
}

#[test]
fn parse_of_false_lengths_and_indices_is_an_error() {
    let error = |json: &str, bytes: &[u8]| parse(glb(json, bytes), Path::new("")).unwrap_err().to_string();
    let bytes = buffer([0, 1, 2]);
    assert_eq!(error(&document(16, INDICES, 54), &bytes), "accessor 0 reaches beyond its buffer");
    assert_eq!(error(&document(12, INDICES, 5400), &bytes), "ends within buffer 0");
    let huge = INDICES.replace("\"count\": 3", "\"count\": 4000000000");
    assert_eq!(error(&document(12, &huge, 54), &bytes), "accessor 1 reaches beyond its buffer");
    let unbacked = huge.replace(
        "\"bufferView\": 1, ",
        r#""sparse": {"count": 1, "indices": {"bufferView": 1, "componentType": 5121}, "values": {"bufferView": 1}}, "#,
    );
    assert_eq!(
        error(&document(12, &unbacked, 54), &bytes),
        "asks for more mesh than its 964 bytes may: 64 bytes of mesh for each byte of the file"
    );
    assert_eq!(
        error(&document(12, INDICES, 54), &buffer([0, 1, 9])),
        "mesh 0, primitive 0 refers to vertex 9, but only 4 are defined"
    );
    let cycle = document(12, INDICES, 54).replace("\"mesh\": 0", "\"children\": [0]");
    assert_eq!(error(&cycle, &bytes), "node 0 has more than one parent");
}

#[test]
fn parse_of_false_chunk_lengths_is_an_error() {
    let source = glb(&document(12, INDICES, 54), &buffer([0, 1, 2]));
    let with_word = |at: usize, value: usize| {
        let mut bytes = source.clone();
        bytes[at..at + 4].copy_from_slice(&u32::try_from(value).unwrap().to_le_bytes());
        parse(bytes, Path::new("")).map(|_| ()).map_err(|error| error.to_string())
    };
    let length = source.len();
    let json = Chunks::find(&source).unwrap().json;
    assert_eq!(with_word(8, length), Ok(()));
    let stated = |stated: usize| Err(format!("its header says that it has {stated} bytes, and it has {length}"));
    assert_eq!(with_word(8, u32::MAX as usize), stated(u32::MAX as usize));
    assert_eq!(with_word(8, length + 1), stated(length + 1));
    assert_eq!(with_word(8, 11), Err("the header says that the file is shorter than its header".to_owned()));
    let cut_off = Err("ends within a chunk".to_owned());
    for (at, value) in [(12, u32::MAX as usize), (12, length), (json.end, u32::MAX as usize), (8, length - 4), (8, 13)]
    {
        assert_eq!(with_word(at, value), cut_off, "{at} {value}");
    }
    assert_eq!(with_word(4, 1), Err("is glTF of version 1; version 2 is read".to_owned()));
    let no_json = Err("not a valid glTF document: the first chunk is not JSON".to_owned());
    assert_eq!(with_word(16, 0), no_json);
    // Without its binary chunk, a buffer without a link has nothing.
    let missing = "buffer 0: it has no `uri`, and there is no binary chunk for it";
    assert_eq!(with_word(8, json.end), Err(missing.to_owned()));
    for end in 0..source.len() {
        parse(source[..end].to_vec(), Path::new("")).unwrap_err();
    }
}

/// A document as a file, read.
fn read(folder: &Path, name: &str, content: &[u8]) -> MeshFile {
    let path = folder.join(name);
    std::fs::write(&path, content).unwrap();
    read_mesh(path).unwrap()
}

fn write(file: &MeshFile, path: &Path, positions: &[[f64; 3]]) -> Vec<u8> {
    let mut bytes = Vec::new();
    Output::new(std::slice::from_ref(file), path).unwrap().write(positions, &mut bytes).unwrap();
    bytes
}

#[test]
fn fixed_vertices_name_the_reason() {
    let plain = document(12, INDICES, 54);
    let reasons = |json: &str| -> Vec<String> {
        let (_, document) = parse(glb(json, &buffer([0, 1, 2])), Path::new("")).unwrap();
        document.fixed_vertices().map(|(range, reason)| format!("{range:?} {reason}")).collect()
    };
    assert_eq!(reasons(&plain), Vec::<String>::new());
    let edit = |from: &str, to: &str| {
        assert!(plain.contains(from), "{from}");
        reasons(&plain.replacen(from, to, 1))
    };
    let second_node = edit(r#"{"translation": [10, 0, 0], "mesh": 0}"#, r#"{"mesh": 0, "children": [2]}, {"mesh": 0}"#);
    assert_eq!(second_node, ["0..4 mesh 0 is used by more than one node", "4..8 mesh 0 is used by more than one node"]);
    let skinned = edit(r#""mesh": 0}],"#, r#""mesh": 0, "skin": 0}], "skins": [{"joints": [0]}],"#);
    assert_eq!(skinned, ["0..4 node 1 is skinned"]);
    let flat = edit("[2, 2, 2]", "[2, 0, 2]");
    assert_eq!(flat, ["0..4 the transform of node 1 can't be inverted"]);
    let twice = edit(r#"{"POSITION": 0}"#, r#"{"POSITION": 0, "NORMAL": 0}"#);
    assert_eq!(twice, ["0..4 accessor 0 is used by something else too"]);
    let compressed = edit(r#""asset""#, r#""extensionsUsed": ["KHR_draco_mesh_compression"], "asset""#);
    assert_eq!(compressed, ["0..4 the document uses KHR_draco_mesh_compression"]);
    let sparse = edit(
        r#""count": 4, "type": "VEC3","#,
        r#""count": 4, "type": "VEC3", "sparse": {
            "count": 1, "indices": {"bufferView": 1, "componentType": 5121}, "values": {"bufferView": 0}},"#,
    );
    assert_eq!(sparse, ["0..4 accessor 0 is sparse"]);
    let overlapping = edit(
        INDICES,
        &format!(r#"{INDICES}, {{"bufferView": 0, "componentType": 5126, "count": 4, "type": "SCALAR"}}"#),
    );
    assert_eq!(overlapping, ["0..4 accessor 0 shares bytes with accessor 2"]);
}

#[test]
fn parse_normalises_integers_where_the_accessor_says_so() {
    let quantised = |normalised: &str| {
        let json = document(12, INDICES, 54).replace("\"byteStride\": 12", "\"byteStride\": 8").replacen(
            "5126",
            &format!("5123{normalised}"),
            1,
        );
        let mut bytes: Vec<u8> = [[0u16, 0, 0, 9], [65_535, 0, 0, 9], [0, 65_535, 0, 9], [1, 1, 1, 9]]
            .iter()
            .flatten()
            .flat_map(|value| value.to_le_bytes())
            .collect();
        bytes.resize(48, 0);
        bytes.extend([0, 0, 1, 0, 2, 0]);
        let (parsed, document) = parse(glb(&json, &bytes), Path::new("")).unwrap();
        let reason = document.fixed_vertices().next().unwrap().1.to_owned();
        (parsed.positions[1], reason)
    };
    let reason = "accessor 0 is quantised".to_owned();
    assert_eq!(quantised(""), ([131_090., 0., 0.], reason.clone()));
    assert_eq!(quantised(", \"normalized\": true"), ([22., 0., 0.], reason));
}
