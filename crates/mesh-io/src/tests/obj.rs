//! OBJ files.

use super::{ODD_OBJ, read, refusal, written};
use crate::{concatenate, read_mesh};

#[test]
fn read_mesh_of_obj_reads_every_form_of_face() {
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
fn write_with_positions_of_obj_changes_moved_coordinates_only() {
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
fn concatenate_drops_texture_coordinates_that_are_incomplete_or_without_area() {
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
fn read_mesh_of_bad_obj_names_file_line_and_element() {
    let cases: [(&str, &str); 13] = [
        ("v 0 0 0\nf 1 2 900\n", "bad.obj:2: face 1 refers to vertex 2, but only 1 are defined"),
        ("v 0 0 0\nf 1 1 1\nf 1 1 900\nv 1 1 1\n", "bad.obj:3: face 2 refers to vertex 900, but only 2 are defined"),
        ("v 0 0 0\nf 1 -2 1\n", "bad.obj:2: face 1 refers to vertex -2, but only 1 are defined"),
        ("v 0 0 0\nf 1/7 1 1\n", "bad.obj:2: face 1 refers to texture coordinate 7, but only 0 are defined"),
        ("v 0 0 0\nf 1 1 4294967297\n", "bad.obj:2: face 1 refers to vertex 4294967297, but only 1 are defined"),
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
    assert!(refusal("bad.fbx", b"Kaydara").contains("not a known mesh format"));
    assert!(read_mesh("/nowhere/a.obj").unwrap_err().to_string().starts_with("/nowhere/a.obj: can't be read: "));
}
