use super::{read, refusal, written};
use crate::FileFormat;

/// Two facets with a common side, and one without an area.
const ASCII: &str = "solid left  sleeve\n  facet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1.50 0 0\n  \
vertex 0 1 0\n endloop\n endfacet\nFACET NORMAL 0 0 0\nOUTER LOOP\nVERTEX 1.50 0 -0\nVERTEX 1e0 1 0.5\n\
VERTEX 0 1 0\nENDLOOP\nENDFACET\nendsolid\nsolid\nfacet normal 1 0 0\nouter loop\nvertex 0 0 0\nvertex 0 0 0\n\
vertex 0 1 0\nendloop\nendfacet\nendsolid\n";

/// The same facets, the header of a program that writes `solid` into it.
fn binary() -> Vec<u8> {
    let mut file = b"solid by a program".to_vec();
    file.resize(80, b' ');
    file.extend(3u32.to_le_bytes());
    let facets: [[f32; 12]; 3] = [
        [0., 0., 1., 0., 0., 0., 1.5, 0., 0., 0., 1., 0.],
        [0., 0., 0., 1.5, 0., -0., 1., 1., 0.5, 0., 1., 0.],
        [1., 0., 0., 0., 0., 0., 0., 0., 0., 0., 1., 0.],
    ];
    for (colour, facet) in (7u16..).zip(facets) {
        facet.iter().for_each(|value| file.extend(value.to_le_bytes()));
        file.extend(colour.to_le_bytes());
    }
    file
}

#[test]
fn corners_of_stl_in_one_place_are_one_vertex() {
    for content in [ASCII.as_bytes(), &binary()] {
        let mesh = read("sheet.STL", content).unwrap();
        assert_eq!(mesh.format(), FileFormat::Stl);
        assert_eq!(mesh.positions(), [[0., 0., 0.], [1.5, 0., 0.], [0., 1., 0.], [1., 1., 0.5]]);
        assert_eq!(mesh.faces(), [[0, 1, 2], [1, 3, 2]]);
        assert_eq!(written(&mesh, mesh.positions()), content);
    }
    let mesh = read("sheet.stl", ASCII.as_bytes()).unwrap();
    assert_eq!(mesh.part_of_face(1).unwrap().to_string(), "solid \"left sleeve\"");
    assert_eq!((mesh.line_of_vertex(3), mesh.is_single_precision()), (Some(12), false));
}

#[test]
fn moved_vertex_of_stl_is_written_at_all_its_corners_with_the_normals() {
    let expected = ASCII
        .replacen("normal 0 0 1", "normal 0 -1 0", 1)
        .replace("vertex 0 1 0", "vertex 0 0 2.5")
        .replace("VERTEX 0 1 0", "VERTEX 0 0 2.5");
    let text = read("sheet.stl", ASCII.as_bytes()).unwrap();
    let mut positions = text.positions().to_vec();
    positions[2] = [0., 0., 2.5];
    // Only the coordinates that changed are other tokens; the facet without an area keeps its normal.
    assert_eq!(String::from_utf8(written(&text, &positions)).unwrap(), expected);
    let before = binary();
    let after = written(&read("sheet.stl", &before).unwrap(), &positions);
    let read_back = read("sheet.stl", &after).unwrap();
    assert_eq!(read_back.positions(), positions);
    let facet = |bytes: &[u8], k: usize| bytes[84 + 50 * k..84 + 50 * (k + 1)].to_vec();
    let normal: Vec<u8> = [0f32, -1., 0.].iter().flat_map(|value| value.to_le_bytes()).collect();
    assert_eq!(facet(&after, 0)[..12], normal);
    assert_eq!(facet(&after, 1)[..36], facet(&before, 1)[..36], "a normal of zeros and corners that stay");
    assert_eq!(facet(&after, 2)[48..], facet(&before, 2)[48..], "the colour");
}

#[test]
fn positions_that_stl_can_not_hold_are_refused() {
    for (content, single) in [(ASCII.as_bytes(), false), (&binary(), true)] {
        let mesh = read("sheet.stl", content).unwrap();
        let refusal = |vertex: usize, position: [f64; 3]| {
            let mut positions = mesh.positions().to_vec();
            positions[vertex] = position;
            mesh.write_with_positions(&positions, &mut Vec::new()).err().map(|error| error.to_string())
        };
        let twice =
            "vertex 3 can't be moved in this file: another vertex is in its place, and STL would make one of them";
        assert_eq!(refusal(3, [0., -0., 0.]).as_deref(), Some(twice));
        assert_eq!(refusal(3, [1e-60, 0., 0.]).as_deref(), single.then_some(twice));
        let beyond = "vertex 1 can't be moved in this file: it is beyond single precision";
        assert_eq!(refusal(1, [1e39, 0., 0.]).as_deref(), single.then_some(beyond));
    }
}

#[test]
fn damaged_stl_is_refused_with_its_place() {
    let text = |from: &str, to: &str| refusal("a.stl", ASCII.replacen(from, to, 1).as_bytes());
    assert_eq!(text("1.50", "x"), "a.stl:5: facet 0 has `x` where a number is needed");
    assert_eq!(text("1.50", "nan"), "a.stl:5: facet 0 has coordinate NaN; coordinates must be finite");
    assert_eq!(text("1.50 0 0", "1.50 0"), "a.stl:5: facet 0 has 2 coordinates, at least 3 are needed");
    assert_eq!(text("  vertex 0 1 0\n", ""), "a.stl:7: facet 0 has 2 corners, 3 are needed");
    assert_eq!(text(" endfacet\n", ""), "a.stl:8: facet 0 has no `endfacet`");
    assert_eq!(text("outer", "inner"), "a.stl:3: `inner` is no line of an STL file");
    assert_eq!(
        refusal("a.stl", ASCII.split("  vertex 0 1 0").next().unwrap().as_bytes()),
        "a.stl: ends within facet 0"
    );
    let file = binary();
    assert_eq!(refusal("a.stl", b"no stl"), "a.stl: ends within the header");
    let mut long = file.clone();
    long[..5].fill(b' ');
    assert_eq!(refusal("a.stl", &long[..180]), "a.stl: ends within facet 1 of 3");
    long[84 + 12..84 + 16].copy_from_slice(&f32::INFINITY.to_le_bytes());
    assert_eq!(refusal("a.stl", &long), "a.stl: facet 0 has coordinate inf; coordinates must be finite");
}
