//! PLY files.

use std::path::Path;

use super::{ASCII_PLY, binary_ply, read, refusal, written};
use crate::{Output, concatenate};

#[test]
fn write_with_positions_of_ascii_ply_keeps_unknown_elements() {
    let mesh = read("odd.ply", ASCII_PLY.as_bytes()).unwrap();
    assert_eq!(mesh.positions(), [[0., 0., 0.], [1.5, 0., 0.], [1., 1., 0.], [0., 1., 0.1]]);
    assert_eq!(mesh.faces(), [[0, 1, 2], [0, 2, 3], [0, 1, 2]]);
    let uvs = concatenate(std::slice::from_ref(&mesh)).unwrap().description.uvs.unwrap();
    assert_eq!(uvs.corners.iter().flatten().map(|&uv| uvs.coordinates[uv as usize]).nth(5), Some([0., 1.]));
    assert_eq!(written(&mesh, mesh.positions()), ASCII_PLY.as_bytes());
    let mut moved = mesh.positions().to_vec();
    moved[1] = [2.5, 0.25, 0.0];
    let expected = ASCII_PLY.replace("255 0 1.50 0 0", "255 0.25 2.5 0 0");
    assert_eq!(String::from_utf8(written(&mesh, &moved)).unwrap(), expected);
}

#[test]
fn write_with_positions_of_binary_ply_patches_either_byte_order() {
    for big in [false, true] {
        for scalar in ["float", "double"] {
            let file = binary_ply(big, scalar);
            let mesh = read("a.ply", &file).unwrap();
            let z = if scalar == "double" { 0.1 } else { f64::from(0.1f32) };
            assert_eq!(mesh.positions(), [[0., 0., z], [1., 0., z], [0., 1., z]]);
            assert_eq!(mesh.faces(), [[0, 1, 2]]);
            assert!(concatenate(std::slice::from_ref(&mesh)).unwrap().description.uvs.is_some());
            assert_eq!(written(&mesh, mesh.positions()), file);
            let mut moved = mesh.positions().to_vec();
            moved[2][1] = -7.25;
            let patched = written(&mesh, &moved);
            assert_eq!(read("a.ply", &patched).unwrap().positions(), moved);
            let size = if scalar == "double" { 8 } else { 4 };
            assert!(patched.iter().zip(&file).filter(|(a, b)| a != b).count() <= size);
        }
    }
}

#[test]
fn read_mesh_of_bad_ply_names_line_and_element() {
    let edit = |from: &str, to: &str| refusal("bad.ply", ASCII_PLY.replace(from, to).as_bytes());
    assert_eq!(edit("255 1 0 0.1 0", "255 1 0 x 0"), "bad.ply:19: vertex 3 has `x` where a number is needed");
    assert_eq!(
        edit("255 1 0 0.1 0", "255 1 0 inf 0"),
        "bad.ply:19: vertex 3 has coordinate inf; coordinates must be finite"
    );
    assert_eq!(edit("4 0 1 2 3 8", "4 0 1 2 9 8"), "bad.ply:21: face 0 refers to vertex 9, but only 4 are defined");
    assert_eq!(edit("4 0 1 2 3 8", "4 0 1 2 -1 8"), "bad.ply:21: face 0 has `-1` where an index is needed");
    assert_eq!(edit("3 0 1 2 6", "2 0 1 6"), "bad.ply:22: face 1 has 2 corners, at least 3 are needed");
    assert_eq!(edit("property double x", "property double w"), "bad.ply: element `vertex` has no property `x`");
    assert_eq!(edit("double z", "quad z"), "bad.ply:8: unknown type `quad`");
    assert_eq!(edit("ascii", "utf8"), "bad.ply:2: unknown format `utf8`");
    assert!(edit("face 2", "face 999999999999").starts_with("bad.ply:22: ends within face 2"));
    // Headers that lie: no memory, no time, one line.
    let file = binary_ply(false, "float");
    let lie = |from: &str, to: &str| {
        let at = file.windows(from.len()).position(|window| window == from.as_bytes()).unwrap();
        refusal("bad.ply", &[&file[..at], to.as_bytes(), &file[at + from.len()..]].concat())
    };
    assert_eq!(lie("vertex 3", "vertex 18446744073709551615"), "bad.ply: ends within vertex 3");
    assert_eq!(lie("uchar uint", "uint uint"), "bad.ply: ends within face 0");
    assert_eq!(
        lie("element face 1\r\n", "element void 99999999999\r\nelement face 1\r\n"),
        "bad.ply: element `void` has no properties"
    );
}

#[test]
fn write_with_positions_of_single_precision_ply_rounds_to_singles() {
    let text = ASCII_PLY.replace("double", "float");
    let mesh = read("a.ply", text.as_bytes()).unwrap();
    assert!(mesh.is_single_precision());
    let mut moved = mesh.positions().to_vec();
    // The same single as 0.1, and another one.
    moved[3][2] = f64::from(0.1f32);
    moved[2][2] = 0.3;
    let written = String::from_utf8(written(&mesh, &moved)).unwrap();
    assert_eq!(written, text.replace("255 1 1 0 1 3", "255 1 1 0.30000001192092896 1 3"));
    moved[1][0] = 1e300;
    let refused = mesh.write_with_positions(&moved, &mut Vec::new()).unwrap_err().to_string();
    assert_eq!(refused, "vertex 1 can't be moved in this file: it is beyond single precision");

    let integers =
        read("a.ply", ASCII_PLY.replace("1.50", "2").replace("0.1 0", "1 0").replace("double", "int").as_bytes())
            .unwrap();
    assert_eq!(integers.fixed_vertices(), [(0..4, "its coordinates are integers")]);
    let positions = integers.positions().to_vec();
    integers.write_with_positions(&positions, &mut Vec::new()).unwrap();
    let refused = integers.write_with_positions(&moved, &mut Vec::new()).unwrap_err().to_string();
    assert!(refused.starts_with("vertex 1 can't be moved"), "{refused}");
}

/// Two elements `vertex`, singles and then doubles; the first has texture coordinates.
fn two_vertex_elements(encoding: &str, second: &str) -> Vec<u8> {
    let mut file = format!(
        "ply\nformat {encoding} 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
         property float s\nproperty float t\nelement vertex 3\nproperty {second} z\nproperty {second} y\n\
         property {second} x\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n"
    )
    .into_bytes();
    let is_text = encoding == "ascii";
    let big = encoding == "binary_big_endian";
    let mut push = |value: f32, scalar: &str| {
        let mut bytes = match scalar {
            "double" => f64::from(value).to_le_bytes().to_vec(),
            #[expect(clippy::cast_possible_truncation)]
            "int" => (value as i32).to_le_bytes().to_vec(),
            _ => value.to_le_bytes().to_vec(),
        };
        if big {
            bytes.reverse();
        }
        file.extend(if is_text { format!("{value} ").into_bytes() } else { bytes });
    };
    for value in [0., 0., 0., 0., 0., 1., 0., 0., 1., 0., 0., 1., 0., 0., 1.] {
        push(value, "float");
    }
    for value in [5., 0., 0., 5., 1., 0., 5., 0., 1.] {
        push(value, second);
    }
    for face in [[0i32, 1, 2], [3, 4, 5]] {
        let words = face.map(|corner| if big { corner.to_be_bytes() } else { corner.to_le_bytes() });
        let text = format!("\n3 {} {} {}", face[0], face[1], face[2]).into_bytes();
        file.extend(if is_text { text } else { [&[3u8], words.as_flattened()].concat() });
    }
    file
}

#[test]
fn write_with_positions_of_two_vertex_elements_uses_the_types_of_each() {
    for encoding in ["ascii", "binary_little_endian", "binary_big_endian"] {
        let file = read("a.ply", &two_vertex_elements(encoding, "double")).unwrap();
        assert!(!file.is_single_precision() && file.fixed_vertices().is_empty());
        assert_eq!(file.positions()[4], [0., 1., 5.]);
        let mut moved = file.positions().to_vec();
        moved[1] = [1.1, -0.2, 0.3];
        moved[4] = [0.1, 1.2, -5.3];
        let output = Output::new(std::slice::from_ref(&file), Path::new("a.ply")).unwrap();
        let again = read("a.ply", &written(&file, &moved)).unwrap();
        let single = [f64::from(1.1f32), f64::from(-0.2f32), f64::from(0.3f32)];
        assert_eq!((again.positions()[1], again.positions()[4]), (single, moved[4]), "{encoding}");
        assert_eq!(output.stored_positions(&moved).unwrap(), again.positions());
        output.check_read_back(&moved, &again).unwrap();

        // Only the vertices of whole numbers are fixed.
        let file = read("a.ply", &two_vertex_elements(encoding, "int")).unwrap();
        assert_eq!(file.fixed_vertices(), [(3..6, "its coordinates are integers")]);
        let mut moved = file.positions().to_vec();
        moved[1][2] = 0.25;
        assert_eq!(read("a.ply", &written(&file, &moved)).unwrap().positions(), moved);
        moved[3][0] = 0.25;
        let refused = file.write_with_positions(&moved, &mut Vec::new()).unwrap_err().to_string();
        assert_eq!(refused, "vertex 3 can't be moved in this file: its coordinates are integers");
    }
}

#[test]
fn check_read_back_names_the_first_difference() {
    let file = read("a.ply", ASCII_PLY.as_bytes()).unwrap();
    let output = Output::new(std::slice::from_ref(&file), Path::new("a.ply")).unwrap();
    let refusal = |meant: &[[f64; 3]], edit: [&str; 2]| {
        let text = ASCII_PLY.replace(edit[0], edit[1]);
        let read = read("a.ply", text.as_bytes()).unwrap();
        output.check_read_back(meant, &read).map_err(|error| error.to_string()).err()
    };
    let words = |what: &str| Some(format!("what was written does not read back as it was meant: {what}"));
    assert_eq!(refusal(file.positions(), ["", ""]), None);
    let mut meant = file.positions().to_vec();
    meant[3][0] = -0.0;
    let differs = "vertex 3 (from 0) was written at (-0, 1, 0.1), and is read at (0, 1, 0.1)";
    assert_eq!(refusal(&meant, ["", ""]), words(differs));
    let corners = "face 0 (from 0) has other corners";
    assert_eq!(refusal(file.positions(), ["4 0 1 2 3 8", "4 0 1 3 2 8"]), words(corners));
    let faces = "2 faces were written, 1 are read";
    assert_eq!(refusal(file.positions(), ["element face 2", "element face 1"]), words(faces));
}
