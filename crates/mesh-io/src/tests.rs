//! Files as a user has them: read, refused, and written back.

#![expect(clippy::float_cmp, reason = "coordinates must come back as the same bits")]

use std::fs;

use super::*;

fn read(name: &str, content: &[u8]) -> Result<MeshFile, ReadError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    fs::write(&path, content).unwrap();
    read_mesh(&path)
}

/// The message, from the file's name on.
fn refusal(name: &str, content: &[u8]) -> String {
    let message = read(name, content).unwrap_err().to_string();
    message[message.find(name).unwrap()..].to_string()
}

fn written(mesh: &MeshFile, positions: &[[f64; 3]]) -> Vec<u8> {
    let mut out = Vec::new();
    mesh.write_with_positions(positions, &mut out).unwrap();
    out
}

/// Everything that the format allows and exporters write.
const ODD_OBJ: &[u8] = b"\xef\xbb\xbf# C:\\models\\\r\nmtllib a.mtl\r\nv 0 0 0\r\nv  1.50\t0 0 1.0\r\nv 1 1 0 0.5 0.5 0.5 # red\r\n\
v 0 1 0\r\nvt 0 0\r\nvt 1 0\r\nvt 1 1\r\nvn 0 0 1\r\ng front back\r\ns off\r\nusemtl caf\xe9\r\nf 1/1 2/2/1 \\\r\n  3/3 4/1/1\r\n\
f -4/-3 -3/-2/-1 -1/-1\r\nl 1 2\r\nf 5/1 1/2 2/3\r\nv 2e0 -.5 +1.25e-1";

#[test]
fn obj_in_all_its_forms() {
    let mesh = read("odd.obj", ODD_OBJ).unwrap();
    assert_eq!(mesh.positions(), [[0., 0., 0.], [1.5, 0., 0.], [1., 1., 0.], [0., 1., 0.], [2., -0.5, 0.125]]);
    assert_eq!(mesh.polygons().len(), 3);
    assert_eq!(mesh.polygons().corners(0), [0, 1, 2, 3]);
    assert_eq!(mesh.polygons().uv_corners(0).unwrap(), [0, 1, 2, 0]);
    assert_eq!(mesh.faces(), [[0, 1, 2], [0, 2, 3], [0, 1, 3], [4, 0, 1]]);
    let world = concatenate(std::slice::from_ref(&mesh)).unwrap();
    assert_eq!(world.description.uvs.unwrap().corners, [[0, 1, 2], [0, 2, 0], [0, 1, 2], [0, 1, 2]]);
}

#[test]
fn obj_comes_back_byte_for_byte_but_for_what_moved() {
    let mesh = read("odd.obj", ODD_OBJ).unwrap();
    assert_eq!(written(&mesh, mesh.positions()), ODD_OBJ);
    let mut moved = mesh.positions().to_vec();
    moved[1][0] = 0.1;
    moved[2][2] = -1e-20;
    moved[4][1] = 3.0;
    let text = written(&mesh, &moved);
    let expected = String::from_utf8_lossy(ODD_OBJ)
        .replace("v  1.50\t0", "v  0.1\t0")
        .replace("v 1 1 0 0.5", "v 1 1 -1e-20 0.5")
        .replace("-.5 +", "3 +");
    assert_eq!(String::from_utf8_lossy(&text), expected);
    assert_eq!(read("odd.obj", &text).unwrap().positions(), moved);
    let wrong = mesh.write_with_positions(&moved[1..], &mut Vec::new()).unwrap_err();
    assert_eq!(wrong.to_string(), "4 positions were given for 5 vertices");
}

#[test]
fn texture_coordinates_count_only_if_all_corners_have_them_and_they_have_area() {
    let uvs = |faces: &str| {
        let text = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n{faces}");
        concatenate(&[read("a.obj", text.as_bytes()).unwrap()]).unwrap().description.uvs.is_some()
    };
    assert!(uvs("f 1/1 2/2 3/3\n"));
    assert!(!uvs("f 1/1 2/2 3/3\nf 2/2 4/1 3\n"));
    assert!(!uvs("f 1/1 2/1 3/1\n"));
    assert!(!uvs("f 1//1 2//1 3//1\n"));
}

#[test]
fn bad_obj_names_file_line_and_element() {
    let cases: [(&str, &str); 12] = [
        ("v 0 0 0\nf 1 2 900\n", "bad.obj:2: face 1 refers to vertex 2, but only 1 are defined"),
        ("v 0 0 0\nf 1 1 1\nf 1 1 900\nv 1 1 1\n", "bad.obj:3: face 2 refers to vertex 900, but only 2 are defined"),
        ("v 0 0 0\nf 1 -2 1\n", "bad.obj:2: face 1 refers to vertex -2, but only 1 are defined"),
        ("v 0 0 0\nf 1/7 1 1\n", "bad.obj:2: face 1 refers to texture coordinate 7, but only 0 are defined"),
        ("v 0 0 0\nf 1 0 1\n", "bad.obj:2: face 1 has `0` where an index is needed"),
        ("v 0 0 0\nf 1 2.5/1 1\n", "bad.obj:2: face 1 has `2.5/1` where an index is needed"),
        ("v 0 0 0\nf 1 1\n", "bad.obj:2: face 1 has 2 corners, at least 3 are needed"),
        ("\n\nv 0 0\n", "bad.obj:3: vertex 1 has 2 coordinates, at least 3 are needed"),
        ("v 0 \\\n0 nan\n", "bad.obj:1: vertex 1 has coordinate NaN; coordinates must be finite"),
        ("v 0 0 0\nv 0 1e999 0\n", "bad.obj:2: vertex 2 has coordinate inf; coordinates must be finite"),
        ("v 0 0 1,5\n", "bad.obj:1: vertex 1 has `1,5` where a number is needed"),
        ("v 0 0 0\nl 1 1\n", "bad.obj: no mesh in it: 1 vertices, 0 faces"),
    ];
    for (content, message) in cases {
        assert_eq!(refusal("bad.obj", content.as_bytes()), message);
    }
    assert!(refusal("bad.obj", b"").contains("no mesh"));
    assert!(refusal("bad.stl", b"solid").contains("not a known mesh format"));
    assert!(read_mesh("/nowhere/a.obj").unwrap_err().to_string().starts_with("/nowhere/a.obj: can't be read: "));
}

const ASCII_PLY: &str = "ply\nformat ascii 1.0\ncomment odd\nelement vertex 4\nproperty uchar red\nproperty double y\n\
property double x\nproperty double z\nproperty list uchar int bones\nelement material 1\nproperty float shine\nelement face 2\n\
property list uchar int vertex_indices\nproperty list uchar float texcoord\nend_header\n255 0 0 0 2 7 8\n255 0 1.50 0 0\n\
255 1 1 0 1 3\n255 1 0 0.1 0\n0.5\n4 0 1 2 3 8 0 0 1 0 1 1 0 1\n3 0 1 2 6 0 0 1 0 1 1\n";

#[test]
fn ascii_ply_keeps_what_it_does_not_understand() {
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

/// A triangle in either byte order, with a list and a colour round the coordinates, and texture coordinates by vertex.
fn binary_ply(big: bool, scalar: &str) -> Vec<u8> {
    let order = if big { "big" } else { "little" };
    let mut file = format!(
        "ply\r\nformat binary_{order}_endian 1.0\r\nelement vertex 3\r\nproperty list uchar short tags\r\nproperty {scalar} x\r\n\
property {scalar} y\r\nproperty {scalar} z\r\nproperty float s\r\nproperty float t\r\nelement face 1\r\n\
property list uchar uint vertex_index\r\nend_header\r\n"
    )
    .into_bytes();
    let mut push = |mut bytes: Vec<u8>| {
        if big {
            bytes.reverse();
        }
        file.extend(bytes);
    };
    for (vertex, [x, y]) in [[0., 0.], [1., 0.], [0., 1.]].into_iter().enumerate() {
        push(vec![u8::try_from(vertex).unwrap()]);
        for _ in 0..vertex {
            push(vec![1, 2]);
        }
        for value in [x, y, 0.1] {
            #[expect(clippy::cast_possible_truncation)]
            push(if scalar == "double" {
                f64::to_le_bytes(value).to_vec()
            } else {
                (value as f32).to_le_bytes().to_vec()
            });
        }
        for value in [x, y] {
            #[expect(clippy::cast_possible_truncation)]
            push((value as f32).to_le_bytes().to_vec());
        }
    }
    push(vec![3]);
    for corner in 0u32..3 {
        push(corner.to_le_bytes().to_vec());
    }
    file
}

#[test]
fn binary_ply_of_either_order_is_patched_in_place() {
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
fn bad_ply_names_what_is_wrong() {
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
fn damaged_files_never_panic() {
    let seeds = [ODD_OBJ.to_vec(), ASCII_PLY.as_bytes().to_vec(), binary_ply(true, "double")];
    let mut state = 7u64;
    let mut next = |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        usize::try_from(state >> 33).unwrap() % below
    };
    let (mut good, mut bad) = (0, 0);
    for round in 0..3_000 {
        let mut bytes = seeds[round % 3].clone();
        for _ in 0..=next(4) {
            let at = next(bytes.len());
            match next(3) {
                0 => bytes[at] = u8::try_from(next(256)).unwrap(),
                1 => bytes.truncate(at + 1),
                _ => bytes.insert(at, b"0-9/\\\n #e"[next(9)]),
            }
        }
        let parsed = if round % 3 == 0 { obj::parse(bytes).map(drop) } else { ply::parse(bytes).map(drop) };
        if parsed.is_ok() { good += 1 } else { bad += 1 }
    }
    assert!(good > 100 && bad > 100, "{good} {bad}");
}

#[test]
fn several_files_are_one_world_and_one_file() {
    let first = read("first.obj", ODD_OBJ).unwrap();
    let second = read("second.ply", &binary_ply(false, "double")).unwrap();
    let world = concatenate(&[first.clone(), second.clone()]).unwrap();
    assert_eq!(world.file_vertices, [0..5, 5..8]);
    assert_eq!(world.file_faces, [0..4, 4..5]);
    assert_eq!(world.description.faces[4], [5, 6, 7]);
    let uvs = world.description.uvs.as_ref().unwrap();
    assert_eq!(uvs.coordinates[uvs.corners[4][1] as usize], [1., 0.]);
    let mut positions = world.positions.clone();
    positions[6][2] = 0.3;
    let files = [first, second];
    let (mut obj, mut ply) = (Vec::new(), Vec::new());
    write_obj(&files, &positions, &mut obj).unwrap();
    write_ply(&files, &positions, &mut ply).unwrap();
    for (name, bytes) in [("both.obj", obj), ("both.ply", ply)] {
        let both = read(name, &bytes).unwrap();
        assert_eq!(both.positions(), positions);
        assert_eq!(both.faces(), world.description.faces);
        assert_eq!(both.polygons().corners(0), [0, 1, 2, 3]);
        let again = concatenate(&[both]).unwrap().description.uvs.unwrap();
        let flat = |uvs: &untangle::mesh::Uvs| -> Vec<[f64; 2]> {
            uvs.corners.iter().flatten().map(|&uv| uvs.coordinates[uv as usize]).collect()
        };
        assert_eq!(flat(&again), flat(uvs));
    }
}

#[test]
fn obj_files_join_with_all_their_lines() {
    let first = read("odd.obj", ODD_OBJ).unwrap();
    let second = b"\xef\xbb\xbf# second\r\nv 9 0 0\r\nv 9 1 0 # up\r\nv 9 0 1\r\nvn 0 1 0\r\nvn 1 0 0\r\nvt .5 .5\r\nf 1/1/2 2//1 \\\r\n3/1\r\n\
l 3 2 1\r\np 1 -1\r\nf -3/-1/-2 -2 -1\r\ng own\r\nusemtl own\r\nf 3 2 1 # \\";
    let second = read("se cond.obj", second).unwrap();
    let third =
        read("third.obj", b"o named\ng x\ns 1\nusemtl y\nv 0 0 0\nv 0 0 1\nv 0 1 1\nf 3//1 1 2\nvn 0 0 1\n").unwrap();
    let files = [first, second, third];
    let world = concatenate(&files).unwrap();
    let mut positions = world.positions.clone();
    positions[6][2] = 0.75;
    let mut joined = Vec::new();
    write_obj(&files, &positions, &mut joined).unwrap();
    let expected = [
        ODD_OBJ,
        b"\no se_cond\r\ng default\r\ns off\r\nusemtl none\r\n# second\r\nv 9 0 0\r\nv 9 1 0.75 # up\r\nv 9 0 1\r\nvn 0 1 0\r\nvn 1 0 0\r\n\
vt .5 .5\r\nf 6/4/3 7//2 \\\r\n8/4\r\nl 8 7 6\r\np 6 -1\r\nf -3/-1/-2 -2 -1\r\ng own\r\nusemtl own\r\nf 8 7 6 # \\\n\n\
o named\ng x\ns 1\nusemtl y\nv 0 0 0\nv 0 0 1\nv 0 1 1\nf 11//4 9 10\nvn 0 0 1\n",
    ]
    .concat();
    assert_eq!(String::from_utf8_lossy(&joined), String::from_utf8_lossy(&expected));
    let both = read("both.obj", &joined).unwrap();
    assert_eq!(both.positions(), positions);
    assert_eq!(both.faces(), world.description.faces);

    // Curves name what they use in ways of their own.
    let curved = read("curved.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\ncurv 0 1 1 2\n").unwrap();
    write_obj(&[curved.clone(), files[0].clone()], &[], &mut Vec::new()).unwrap();
    let refused = write_obj(&[files[0].clone(), curved], &[], &mut Vec::new()).unwrap_err().to_string();
    assert!(refused.ends_with("curved.obj:5: `curv` can't be joined to other files"), "{refused}");
}

#[test]
fn names_say_what_is_written() {
    let obj = read("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n# end").unwrap();
    let ply = read("b.ply", &binary_ply(false, "float")).unwrap();
    let write = |files: &[MeshFile], name: &str| {
        let positions: Vec<[f64; 3]> = files.iter().flat_map(MeshFile::positions).copied().collect();
        let mut bytes = Vec::new();
        Output::new(files, std::path::Path::new(name))?.write(&positions, &mut bytes)?;
        Ok::<_, WriteError>(bytes)
    };
    let one = std::slice::from_ref(&obj);
    assert!(write(one, "c.OBJ").unwrap().ends_with(b"f 1 2 3\n# end"));
    assert!(write(one, "c.ply").unwrap().starts_with(b"ply\nformat binary_little_endian"));
    assert_eq!(write(std::slice::from_ref(&ply), "c.ply").unwrap(), binary_ply(false, "float"));
    let mixed = write(&[obj.clone(), ply.clone()], "c.obj").unwrap();
    assert!(mixed.starts_with(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n# end\no b\nv 0 0 0.10000000149011612\n"));
    assert!(matches!(write(one, "c.stl"), Err(WriteError::UnknownFormat)));
    for name in ["c.glb", "c.gltf"] {
        assert!(matches!(write(one, name), Err(WriteError::OnlyFromGltf)));
    }
    assert!(Output::new(std::slice::from_ref(&ply), std::path::Path::new("c.ply")).unwrap().is_single_precision());
    assert!(!Output::new(&[ply.clone(), obj], std::path::Path::new("c.ply")).unwrap().is_single_precision());
    assert!(!Output::new(std::slice::from_ref(&ply), std::path::Path::new("c.obj")).unwrap().is_single_precision());
}

#[test]
fn ply_text_of_single_precision_gets_singles() {
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
