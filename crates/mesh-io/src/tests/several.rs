//! Several files as one world and as one file.

#![expect(clippy::float_cmp, reason = "coordinates must come back as the same bits")]

use super::{ODD_OBJ, binary_ply, read};
use crate::{MeshFile, Output, WriteError, concatenate, write_obj, write_ply};

#[test]
fn write_obj_and_write_ply_of_several_files_read_back_as_their_world() {
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
        Output::new(&files, std::path::Path::new(name)).unwrap().check_read_back(&positions, &both).unwrap();
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
fn write_obj_of_obj_files_keeps_their_lines_and_shifts_their_indices() {
    let first = read("odd.obj", ODD_OBJ).unwrap();
    let second = b"\xef\xbb\xbf# second\r\nv 9 0 0\r\nv 9 1 0 # up\r\nv 9 0 1\r\nvn 0 1 0\r\n\
vn 1 0 0\r\nvt .5 .5\r\nf 1/1/2 2//1 \\\r\n3/1\r\n\
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
        b"\no se_cond\r\ng default\r\ns off\r\nusemtl none\r\n# second\r\nv 9 0 0\r\nv 9 1 0.75 # up\r\n\
v 9 0 1\r\nvn 0 1 0\r\nvn 1 0 0\r\n\
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
fn output_takes_its_format_from_the_extension() {
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
    assert!(matches!(write(one, "c.fbx"), Err(WriteError::UnknownFormat)));
    assert!(matches!(write(one, "c.stl"), Err(WriteError::OnlyFromStl)));
    for name in ["c.glb", "c.gltf"] {
        assert!(matches!(write(one, name), Err(WriteError::OnlyFromGltf)));
    }
    assert!(Output::new(std::slice::from_ref(&ply), std::path::Path::new("c.ply")).unwrap().is_single_precision());
    assert!(!Output::new(&[ply.clone(), obj], std::path::Path::new("c.ply")).unwrap().is_single_precision());
    assert!(!Output::new(std::slice::from_ref(&ply), std::path::Path::new("c.obj")).unwrap().is_single_precision());
}
