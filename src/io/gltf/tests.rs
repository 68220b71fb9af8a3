use super::*;

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
fn nodes_are_applied_and_shared_points_stay_shared() {
    let parsed = parse(&glb(&document(12, INDICES, 54), &buffer([0, 1, 2])), None).unwrap();
    assert_eq!(parsed.positions, [[20., 0., 0.], [22., 0., 0.], [20., 2., 0.], [22., 2., 0.]]);
    let faces: Vec<&[u32]> = (0..parsed.polygons.len()).map(|face| parsed.polygons.corners(face)).collect();
    assert_eq!(faces, [[0, 1, 2], [0, 1, 2], [2, 1, 3]]);
}

#[test]
fn lies_about_buffers_are_errors() {
    let error = |json: &str, bytes: &[u8]| parse(&glb(json, bytes), None).unwrap_err().to_string();
    let bytes = buffer([0, 1, 2]);
    assert_eq!(error(&document(16, INDICES, 54), &bytes), "accessor 0 reaches beyond its buffer");
    assert_eq!(error(&document(12, INDICES, 5400), &bytes), "ends within buffer 0");
    let huge = INDICES.replace("\"count\": 3", "\"count\": 4000000000");
    assert_eq!(error(&document(12, &huge, 54), &bytes), "accessor 1 reaches beyond its buffer");
    let unbacked = huge.replace(
        "\"bufferView\": 1, ",
        r#""sparse": {"count": 1, "indices": {"bufferView": 1, "componentType": 5121}, "values": {"bufferView": 1}}, "#,
    );
    assert_eq!(error(&document(12, &unbacked, 54), &bytes), "accessor 1 has too many elements without a buffer");
    assert_eq!(
        error(&document(12, INDICES, 54), &buffer([0, 1, 9])),
        "mesh 0, primitive 0 refers to vertex 9, but only 4 are defined"
    );
    let cycle = document(12, INDICES, 54).replace("\"mesh\": 0", "\"children\": [0]");
    assert_eq!(error(&cycle, &bytes), "node 0 has more than one parent");
}
