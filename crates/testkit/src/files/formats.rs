//! One mesh in every format that can be read, written without the program's own writers.

use std::fmt::Write;

use crate::generate::Sheet;

/// Formats that hold double precision, with the ends of their files' names.
pub fn exact(sheet: &Sheet) -> Vec<(&'static str, Vec<u8>)> {
    vec![
        ("plain.obj", obj(sheet, false)),
        ("backwards.obj", obj(sheet, true)),
        ("ascii.ply", ascii_ply(sheet)),
        ("little.ply", binary_ply(sheet, false)),
        ("big.ply", binary_ply(sheet, true)),
    ]
}

/// The same sheet with positions rounded to single precision.
pub fn rounded(sheet: &Sheet) -> Sheet {
    let mut sheet = sheet.clone();
    sheet.positions.iter_mut().flatten().for_each(|x| *x = f64::from(*x as f32));
    sheet
}

/// As OBJ, with faces by indices from the front, or from the end.
pub fn obj(sheet: &Sheet, backwards: bool) -> Vec<u8> {
    let mut text = String::from("# a test\no cloth\n");
    for [x, y, z] in &sheet.positions {
        writeln!(text, "v {x:e} {y:e} {z:e}").unwrap();
    }
    let count = i64::try_from(sheet.positions.len()).unwrap();
    for corners in &sheet.faces {
        let [a, b, c] = corners.map(|corner| i64::from(corner) + if backwards { -count } else { 1 });
        writeln!(text, "f {a} {b} {c}").unwrap();
    }
    text.into_bytes()
}

/// As [`obj`], with texture coordinates: one for each vertex.
pub fn obj_with_uvs(sheet: &Sheet) -> Vec<u8> {
    let mut text = String::new();
    for ([x, y, z], [u, v]) in sheet.positions.iter().zip(&sheet.uvs) {
        writeln!(text, "v {x:e} {y:e} {z:e}\nvt {u:e} {v:e}").unwrap();
    }
    for corners in &sheet.faces {
        let [a, b, c] = corners.map(|corner| corner + 1);
        writeln!(text, "f {a}/{a} {b}/{b} {c}/{c}").unwrap();
    }
    text.into_bytes()
}

fn ply_header(sheet: &Sheet, format: &str) -> String {
    format!(
        "ply\nformat {format} 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\n\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        sheet.positions.len(),
        sheet.faces.len()
    )
}

/// As PLY text in double precision.
pub fn ascii_ply(sheet: &Sheet) -> Vec<u8> {
    let mut text = ply_header(sheet, "ascii");
    for [x, y, z] in &sheet.positions {
        writeln!(text, "{x:e} {y:e} {z:e}").unwrap();
    }
    for [a, b, c] in &sheet.faces {
        writeln!(text, "3 {a} {b} {c}").unwrap();
    }
    text.into_bytes()
}

/// As binary PLY in double precision, big-endian or little-endian.
pub fn binary_ply(sheet: &Sheet, big: bool) -> Vec<u8> {
    let mut file = ply_header(sheet, if big { "binary_big_endian" } else { "binary_little_endian" }).into_bytes();
    for x in sheet.positions.iter().flatten() {
        file.extend(if big { x.to_be_bytes() } else { x.to_le_bytes() });
    }
    for corners in &sheet.faces {
        file.push(3);
        for corner in corners {
            file.extend(if big { corner.to_be_bytes() } else { corner.to_le_bytes() });
        }
    }
    file
}

/// The points and triangles of a sheet as a glTF document with a buffer of this address, and the buffer.
fn gltf_parts(sheet: &Sheet, address: &str) -> (String, Vec<u8>) {
    let mut buffer: Vec<u8> = sheet.positions.iter().flatten().flat_map(|&x| (x as f32).to_le_bytes()).collect();
    let points = buffer.len();
    buffer.extend(sheet.faces.iter().flatten().flat_map(|corner| corner.to_le_bytes()));
    let bound = |pick: fn(f32, f32) -> f32| -> [f32; 3] {
        std::array::from_fn(|axis| sheet.positions.iter().map(|p| p[axis] as f32).reduce(pick).unwrap())
    };
    let mut document = serde_json::json!({
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": sheet.positions.len(), "type": "VEC3",
             "min": bound(f32::min), "max": bound(f32::max)},
            {"bufferView": 1, "componentType": 5125, "count": 3 * sheet.faces.len(), "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": points},
            {"buffer": 0, "byteOffset": points, "byteLength": buffer.len() - points},
        ],
        "buffers": [{"byteLength": buffer.len()}],
    });
    if !address.is_empty() {
        document["buffers"][0]["uri"] = address.into();
    }
    (document.to_string(), buffer)
}

/// A glTF document and the buffer that it finds at an address.
pub fn gltf(sheet: &Sheet, address: &str) -> (Vec<u8>, Vec<u8>) {
    let (document, buffer) = gltf_parts(sheet, address);
    (document.into_bytes(), buffer)
}

/// As GLB: one file with document and buffer.
pub fn glb(sheet: &Sheet) -> Vec<u8> {
    let (document, buffer) = gltf_parts(sheet, "");
    glb_file(document.into_bytes(), buffer)
}

/// Puts a document and its buffer into one GLB file, padded as the format wants it.
pub fn glb_file(mut document: Vec<u8>, mut buffer: Vec<u8>) -> Vec<u8> {
    document.resize(document.len().next_multiple_of(4), b' ');
    buffer.resize(buffer.len().next_multiple_of(4), 0);
    let word = |value: usize| u32::try_from(value).unwrap().to_le_bytes();
    let mut file = b"glTF\x02\0\0\0".to_vec();
    file.extend(word(12 + 8 + document.len() + 8 + buffer.len()));
    for (kind, chunk) in [(b"JSON", &document), (b"BIN\0", &buffer)] {
        file.extend(word(chunk.len()));
        file.extend(kind);
        file.extend(chunk);
    }
    file
}
