//! Named parts of files.

use super::read;
use crate::{MeshFile, Part};

fn shown(part: Option<&Part>) -> String {
    part.map_or_else(String::new, ToString::to_string)
}

/// The name of each face, and of each vertex.
fn names(file: &MeshFile) -> [Vec<String>; 2] {
    let faces = (0..file.faces().len()).map(|face| shown(file.part_of_face(face)));
    [faces.collect(), file.vertex_parts().into_iter().map(shown).collect()]
}

#[test]
fn parts_of_obj_are_its_objects_and_groups() {
    let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 5 5 5\nf 1 2 3\no shirt\ng left  sleeve # old\nf 1 2 3 4\n\
                o body\nv 9 9 9\ng\nf 4 5 1\nf 1 2 3\ng \u{1b}[2J\no empty\n";
    let file = read("a.obj", text.as_bytes()).unwrap();
    let sleeve = "object \"shirt\", group \"left sleeve\"";
    let body = "object \"body\"";
    let [faces, vertices] = names(&file);
    assert_eq!(faces, ["", sleeve, sleeve, body, body]);
    // The fifth vertex stands before all names and is used by the body, the last stands in the body.
    assert_eq!(vertices, [sleeve, sleeve, sleeve, sleeve, body, "object \"body\", group \"left sleeve\""]);
    assert!(file.parts().iter().all(|part| !part.faces.is_empty() || !part.vertices.is_empty()));
    let escaping = read("a.obj", b"g \x1b[2J\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    assert_eq!(shown(escaping.part_of_face(0)), "group \"\\u{1b}[2J\"");
}

#[test]
fn parts_of_gltf_are_its_nodes_and_meshes() {
    let buffer = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";
    let text = format!(
        r#"{{"asset": {{"version": "2.0"}}, "nodes": [{{"mesh": 0, "name": "left"}}, {{"mesh": 0}}],
        "meshes": [{{"name": "sleeve", "primitives": [{{"attributes": {{"POSITION": 0}}}}]}}],
        "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
        "min": [0, 0, 0], "max": [1, 1, 0]}}], "bufferViews": [{{"buffer": 0, "byteLength": 36}}],
        "buffers": [{{"byteLength": 36, "uri": "data:application/octet-stream;base64,{buffer}"}}]}}"#
    );
    let file = read("a.gltf", text.as_bytes()).unwrap();
    let left = "node \"left\", mesh \"sleeve\"";
    let [faces, vertices] = names(&file);
    assert_eq!(faces, [left, "mesh \"sleeve\""]);
    assert_eq!(vertices, [left, left, left, "mesh \"sleeve\"", "mesh \"sleeve\"", "mesh \"sleeve\""]);
}
