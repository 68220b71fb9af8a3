//! glTF from strangers: what is refused, and in which words.

use std::fs;

use serde_json::{Value, json};

use crate::{Output, read_mesh};

/// A triangle in a buffer with this link; its positions are three singles each.
fn document(uri: &str) -> Value {
    json!({
        "asset": {"version": "2.0"}, "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "buffers": [{"byteLength": 36, "uri": uri}]
    })
}

const TRIANGLE: &str = "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";

/// The refusal of a document, or nothing.
fn refusal(document: &Value) -> Option<String> {
    let error = super::read("a.gltf", document.to_string().as_bytes()).err()?.to_string();
    Some(error.split_once("a.gltf: ").unwrap().1.to_owned())
}

/// A document with other members.
fn with(changes: &[(&str, Value)]) -> Value {
    let mut document = document(TRIANGLE);
    for (pointer, value) in changes {
        let (parent, member) = pointer.rsplit_once('/').unwrap();
        match document.pointer_mut(parent).unwrap() {
            Value::Array(list) if member == "-" => list.push(value.clone()),
            Value::Array(list) => list[member.parse::<usize>().unwrap()] = value.clone(),
            parent => parent[member] = value.clone(),
        }
    }
    document
}

#[test]
fn read_mesh_of_links_out_of_the_folder_is_refused() {
    assert_eq!(refusal(&document(TRIANGLE)), None);
    for (link, reason) in [
        ("/etc/passwd", "is not a relative path"),
        ("../../../../../../etc/passwd", "leads out of the folder"),
        ("/dev/zero", "is not a relative path"),
        ("%2e%2e/%2e%2e/etc/passwd", "leads out of the folder"),
    ] {
        let expected = format!("buffer 0: link `{link}` {reason}; only files in the folder of the document are read");
        assert_eq!(refusal(&document(link)), Some(expected));
    }
    let escaping = refusal(&document("\u{1b}[2J/\u{202e}a.bin")).unwrap();
    assert!(escaping.contains("\\u{1b}[2J/\\u{202e}a.bin") && !escaping.contains('\u{1b}'), "{escaping}");
    // A buffer that nothing uses is refused as well.
    let exfiltrating = with(&[("/buffers/-", json!({"byteLength": 64, "uri": "/etc/passwd"}))]);
    assert!(refusal(&exfiltrating).unwrap().starts_with("buffer 1: link `/etc/passwd`"));
}

#[test]
fn output_embeds_no_more_of_a_linked_file_than_its_buffer() {
    let folder = tempfile::tempdir().unwrap();
    let mut bytes: Vec<u8> = [0f32, 0., 0., 1., 0., 0., 0., 1., 0.].iter().flat_map(|x| x.to_le_bytes()).collect();
    bytes.extend(b"secret secret secret");
    fs::write(folder.path().join("a.bin"), &bytes).unwrap();
    // The same file twice, and as an image, which is not read.
    let mut document = document("a.bin");
    document["buffers"].as_array_mut().unwrap().push(json!({"byteLength": 4, "uri": "./a.bin"}));
    document["images"] = json!([{"uri": "../missing.png"}]);
    let path = folder.path().join("a.gltf");
    fs::write(&path, document.to_string()).unwrap();
    let file = read_mesh(&path).unwrap();
    let elsewhere = folder.path().join("elsewhere");
    fs::create_dir(&elsewhere).unwrap();
    let mut written = Vec::new();
    let files = std::slice::from_ref(&file);
    Output::new(files, &elsewhere.join("b.gltf")).unwrap().write(file.positions(), &mut written).unwrap();
    let written: Value = serde_json::from_slice(&written).unwrap();
    let expected = format!("{TRIANGLE}==").replace("AAAA==", "AAAA");
    assert_eq!(written["buffers"][0]["uri"], expected);
    assert_eq!(written["buffers"][1]["uri"], "data:application/octet-stream;base64,AAAAAA==");
}

#[test]
fn read_mesh_of_documents_that_ask_for_more_than_their_bytes_is_refused() {
    let sparse = json!({"count": 1, "indices": {"bufferView": 1, "componentType": 5121},
                        "values": {"bufferView": 0}});
    let unbacked =
        |count: u64| json!({"componentType": 5126, "count": count, "type": "VEC3", "sparse": sparse.clone()});
    let view = json!({"buffer": 0, "byteOffset": 0, "byteLength": 4});
    let small = with(&[("/bufferViews/-", view.clone()), ("/accessors/0", unbacked(16_777_216))]);
    let refused = |document: &Value| {
        let error = refusal(document).unwrap();
        assert!(error.starts_with("asks for more mesh than its "), "{error}");
    };
    refused(&small);
    refused(&with(&[("/bufferViews/-", view.clone()), ("/accessors/0", unbacked(u64::MAX))]));
    // What the bytes of the file may ask for is read.
    assert_eq!(refusal(&with(&[("/bufferViews/-", view), ("/accessors/0", unbacked(300))])), None);
    // Many nodes with many primitives each, even of nothing.
    let nodes: Vec<Value> = (0..3_000).map(|_| json!({"mesh": 0})).collect();
    let empty = json!({"componentType": 5126, "count": 0, "type": "VEC3"});
    let primitives: Vec<Value> = (0..3_000).map(|_| json!({"attributes": {"POSITION": 0}})).collect();
    refused(&with(&[("/nodes", nodes.into()), ("/accessors/0", empty), ("/meshes/0/primitives", primitives.into())]));
    // A few nodes with one mesh are ordinary.
    let nodes: Vec<Value> = (0..100).map(|_| json!({"mesh": 0})).collect();
    assert_eq!(refusal(&with(&[("/nodes", nodes.into())])), None);
    // Texture coordinates and indices that no buffer holds.
    let floats = json!({"componentType": 5126, "count": 99_999_999u64, "type": "VEC2"});
    refused(&with(&[("/accessors/-", floats), ("/meshes/0/primitives/0/attributes/TEXCOORD_0", json!(1))]));
    let indices = json!({"componentType": 5125, "count": 99_999_999u64, "type": "SCALAR"});
    refused(&with(&[("/accessors/-", indices), ("/meshes/0/primitives/0/indices", json!(1))]));
}

#[test]
fn read_mesh_of_required_extensions_refuses_those_that_touch_positions() {
    let required = |name: &str| with(&[("/extensionsRequired", json!([name])), ("/extensionsUsed", json!([name]))]);
    for name in ["KHR_texture_basisu", "KHR_mesh_quantization", "KHR_lights_punctual", "ACME_unknown"] {
        assert_eq!(refusal(&required(name)), None, "{name}");
    }
    for (name, words) in [
        ("KHR_draco_mesh_compression", "Draco-compressed meshes are not read; export the model without compression"),
        ("EXT_meshopt_compression", "meshopt-compressed meshes are not read; export the model without compression"),
        ("EXT_mesh_gpu_instancing", "it changes where vertices or faces are, and is not read; export the model"),
    ] {
        let error = refusal(&required(name)).unwrap();
        assert!(error.starts_with(&format!("needs the glTF extension {name}: {words}")), "{error}");
    }
    // Data that is there in a compressed form only, whether or not the document says that it needs it.
    let draco = json!({"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {"POSITION": 0}}});
    let bare = json!({"componentType": 5126, "count": 3, "type": "VEC3"});
    let undeclared = with(&[("/accessors/0", bare), ("/meshes/0/primitives/0/extensions", draco)]);
    assert!(refusal(&undeclared).unwrap().contains("Draco-compressed"));
    let fallback = with(&[
        ("/buffers/-", json!({"byteLength": 9, "extensions": {"EXT_meshopt_compression": {"fallback": true}}})),
        ("/extensionsUsed", json!(["EXT_meshopt_compression"])),
    ]);
    assert!(refusal(&fallback).unwrap().contains("meshopt-compressed"));
}

#[test]
fn read_mesh_of_what_is_no_gltf_says_so() {
    let invalid = |document: &Value| {
        let error = refusal(document).unwrap();
        assert!(!error.contains("usize") && !error.contains("u64") && !error.contains("struct"), "{error}");
        error.strip_prefix("not a valid glTF document: ").map(str::to_owned).unwrap_or_else(|| panic!("{error}"))
    };
    assert!(invalid(&json!({"meshes": []})).starts_with("missing field `asset`"));
    assert!(invalid(&json!(1)).contains("an object is needed"));
    assert!(invalid(&with(&[("/buffers/0", json!({"byte1/2/3h": 104}))])).starts_with("missing field `byteLength`"));
    assert!(invalid(&with(&[("/accessors/0/count", json!("3"))])).contains("expected a whole number at line 1"));
    assert!(invalid(&with(&[("/accessors/0/count", json!(-3))])).contains("expected a whole number at line 1"));
    assert!(invalid(&with(&[("/nodes/0/scale", json!([1, 1, "x"]))])).contains("expected a number at line 1"));
    for (pointer, words) in [
        ("/nodes/0/mesh", "node 0 refers to mesh 7, but only 1 are defined"),
        ("/scene", "the document refers to scene 7, but only 0 are defined"),
        ("/meshes/0/primitives/0/indices", "mesh 0, primitive 0 refers to accessor 7, but only 1 are defined"),
        ("/accessors/0/bufferView", "accessor 0 refers to buffer view 7, but only 1 are defined"),
        ("/bufferViews/0/buffer", "buffer view 0 refers to buffer 7, but only 1 are defined"),
        ("/meshes/0/primitives/0/mode", "mesh 0, primitive 0 has mode 7, which does not exist"),
    ] {
        assert_eq!(invalid(&with(&[(pointer, json!(7))])), words);
    }
    let refused = |pointer, value| refusal(&with(&[(pointer, value)])).unwrap();
    assert_eq!(refused("/asset/version", json!("1.0")), "is glTF of version `1.0`; version 2.0 is read");
    assert_eq!(
        refused("/bufferViews/0/byteStride", json!(4)),
        "accessor 0 has elements that overlap each other: its `byteStride` is too small"
    );
    let words = "accessor 0 has the wrong type, or the wrong number of components";
    assert_eq!(refused("/accessors/0/componentType", json!(5130)), words);
    assert_eq!(refused("/accessors/0/type", json!("VEC2")), words);
    assert_eq!(refused("/accessors/0/byteOffset", json!(4)), "accessor 0 reaches beyond its buffer");
    // There are more bytes, which would be lost when the file is written.
    assert_eq!(refused("/buffers/0/byteLength", json!(34)), "accessor 0 reaches beyond its buffer");
    assert_eq!(refused("/buffers/0/byteLength", json!(0)), "accessor 0 reaches beyond its buffer");
    assert_eq!(
        refused("/buffers/0/uri", Value::Null),
        "buffer 0: it has no `uri`, and there is no binary chunk for it"
    );
}

#[test]
fn write_of_positions_that_are_something_else_too_is_refused() {
    let view = json!({"buffer": 0, "byteOffset": 0, "byteLength": 36});
    let sparse = json!({"componentType": 5126, "count": 3, "type": "VEC3", "sparse": {"count": 1,
        "indices": {"bufferView": 1, "componentType": 5121}, "values": {"bufferView": 1}}});
    let aliased = with(&[("/bufferViews/-", view.clone()), ("/accessors/-", sparse)]);
    let image = with(&[("/bufferViews/-", view), ("/images", json!([{"bufferView": 1}]))]);
    let instanced = with(&[("/nodes/0/extensions", json!({"EXT_mesh_gpu_instancing": {"attributes": {}}}))]);
    for (document, reason) in [
        (aliased, "accessor 0 shares bytes with the sparse elements of accessor 1"),
        (image, "accessor 0 shares bytes with image 0"),
        (instanced, "node 0 is instanced"),
    ] {
        let file = super::read("a.gltf", document.to_string().as_bytes()).unwrap();
        assert_eq!(file.fixed_vertices(), [(0..3, reason)]);
        let mut moved = file.positions().to_vec();
        moved[1][0] = 0.5;
        let refused = file.write_with_positions(&moved, &mut Vec::new()).unwrap_err().to_string();
        assert_eq!(refused, format!("vertex 1 can't be moved in this file: {reason}"));
    }
}
