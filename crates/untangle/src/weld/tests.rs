#![expect(clippy::float_cmp, reason = "coordinates must come back as the same bits")]

use super::*;

fn describe(num_vertices: usize, faces: &[[u32; 3]]) -> MeshDescription {
    MeshDescription { num_vertices, faces: faces.to_vec(), ..Default::default() }
}

fn firsts(positions: &[[f64; 3]], faces: &[[u32; 3]], parts: &[Range<usize>], distance_m: f64) -> Vec<u32> {
    let weld = Weld::find(&describe(positions.len(), faces), positions, parts, distance_m).unwrap();
    (0..).take(positions.len()).map(|vertex| weld.first(weld.of(vertex))).collect()
}

const A: [f64; 3] = [0.0, 0.0, 0.0];
const B: [f64; 3] = [1.0, 0.0, 0.0];
const C: [f64; 3] = [0.0, 1.0, 0.5];
const D: [f64; 3] = [0.0, -1.0, 0.5];

#[test]
fn weld_of_two_faces_along_a_doubled_edge_joins_its_ends() {
    let faces = [[0, 1, 2], [3, 4, 5]];
    let zero = [-0.0, 0.0, -0.0];
    for (positions, expected) in [
        ([A, B, C, B, zero, D], [0, 1, 2, 1, 0, 5]),
        // Turned over, as a panel with other normals.
        ([A, B, C, A, B, D], [0, 1, 2, 0, 1, 5]),
        // One common place is no common edge.
        ([A, B, C, A, [2.0; 3], D], [0, 1, 2, 3, 4, 5]),
    ] {
        assert_eq!(firsts(&positions, &faces, &[], 0.0), expected);
        // Nothing is welded across parts.
        assert_eq!(firsts(&positions, &faces, &[0..3, 3..6], 0.0), [0, 1, 2, 3, 4, 5]);
    }
}

#[test]
fn weld_of_a_vertex_split_in_the_middle_of_a_sheet_joins_it() {
    // A square round its middle, which two of the four faces have as vertex 5.
    let positions =
        [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.5, 0.5, 0.0], [0.5, 0.5, 0.0]];
    let faces = [[0, 1, 4], [1, 2, 4], [2, 3, 5], [3, 0, 5]];
    assert_eq!(firsts(&positions, &faces, &[], 0.0), [0, 1, 2, 3, 4, 4]);
}

#[test]
fn weld_of_layers_and_of_crossing_sheets_joins_nothing() {
    // Two faces in one place that face the same way.
    assert_eq!(firsts(&[A, B, C, B, C, A], &[[0, 1, 2], [3, 4, 5]], &[], 0.0), [0, 1, 2, 3, 4, 5]);
    // Two sheets that cross in the edge A B, which is no boundary of either.
    let up = [0.0, 0.3, 1.0];
    let down = [0.0, 0.3, -1.0];
    let positions = [A, B, C, D, A, B, up, down];
    let faces = [[0, 1, 2], [1, 0, 3], [4, 5, 6], [5, 4, 7]];
    assert_eq!(firsts(&positions, &faces, &[], 0.0), [0, 1, 2, 3, 4, 5, 6, 7]);
}

#[test]
fn weld_of_a_boundary_on_an_edge_joins_them_unless_two_edges_lie_there() {
    let up = [0.0, 0.3, 1.0];
    let sewn = [A, B, C, D, A, B, up];
    let faces = [[0, 1, 2], [1, 0, 3], [4, 5, 6]];
    assert_eq!(firsts(&sewn, &faces, &[], 0.0), [0, 1, 2, 3, 0, 1, 6]);
    let (down, far) = ([0.0, 0.3, -1.0], [0.0, 2.0, 2.0]);
    let both = [A, B, C, D, A, B, up, down, A, B, far];
    let faces = [[0, 1, 2], [1, 0, 3], [4, 5, 6], [5, 4, 7], [8, 9, 10]];
    assert_eq!(firsts(&both, &faces, &[], 0.0), [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10]);
}

#[test]
fn weld_of_a_double_sided_sheet_joins_its_hem_only() {
    // A square round its middle, upper and lower side; the middles lie in one place too.
    let ring = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let middle = [0.5, 0.5, 0.0];
    let positions = [&ring[..], &[middle], &ring[..], &[middle]].concat();
    let upper = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
    let lower = upper.map(|[a, b, c]| [b + 5, a + 5, c + 5]);
    let faces = [upper, lower].concat();
    assert_eq!(firsts(&positions, &faces, &[], 0.0), [0, 1, 2, 3, 4, 0, 1, 2, 3, 9]);
}

#[test]
fn weld_of_an_edge_without_length_contracts_it() {
    // A fan round vertex 4, and vertex 5 on it.
    let ring = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let middle = [0.5, 0.5, 0.0];
    let positions = [&ring[..], &[middle, middle]].concat();
    let faces = [[0, 1, 4], [1, 2, 5], [2, 3, 5], [3, 0, 4], [1, 5, 4], [5, 3, 4]];
    assert_eq!(firsts(&positions, &faces, &[], 0.0), [0, 1, 2, 3, 4, 4]);
    let weld = Weld::find(&describe(6, &faces), &positions, &[], 0.0).unwrap();
    assert_eq!(weld.num_merged(), 1);
    // The faces without width keep their ids, and have a repeated vertex now.
    assert_eq!(weld.describe(&describe(6, &faces)).faces[4], [1, 4, 4]);
    // A cloth in one point would have no face left.
    assert_eq!(firsts(&[A, A, A, A], &[[0, 1, 2], [2, 1, 3]], &[], 0.0), [0, 1, 2, 3]);
    // A bridge of two faces would become two sheets that hang together in a point.
    let bridge = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], middle, middle];
    assert_eq!(firsts(&bridge, &[[0, 2, 3], [2, 1, 3]], &[], 0.0), [0, 1, 2, 3]);
}

#[test]
fn weld_of_a_vertex_without_face_goes_with_the_first_in_its_place() {
    assert_eq!(firsts(&[A, A, B, C, A, D, D], &[[1, 2, 3]], &[], 0.0), [0, 0, 2, 3, 0, 5, 5]);
}

#[test]
fn weld_within_a_distance_does_not_depend_on_the_order_of_vertices() {
    let near = |[x, y, z]: [f64; 3], by: f64| [x + by, y - by, z];
    let positions = [A, B, C, near(B, 4e-4), near(A, -4e-4), D];
    let faces = [[0, 1, 2], [3, 4, 5]];
    assert_eq!(firsts(&positions, &faces, &[], 1e-3), [0, 1, 2, 1, 0, 5]);
    assert_eq!(firsts(&positions, &faces, &[], 1e-4), [0, 1, 2, 3, 4, 5]);
    assert_eq!(firsts(&positions, &faces, &[], 1e-320), [0, 1, 2, 3, 4, 5]);
    // All in one place: no edge has a length then, and there is no seam.
    assert_eq!(firsts(&positions, &faces, &[], 1e3), [0, 1, 2, 3, 4, 5]);
    let reversed: Vec<[f64; 3]> = positions.iter().rev().copied().collect();
    let faces = faces.map(|face| face.map(|corner| 5 - corner));
    assert_eq!(firsts(&reversed, &faces, &[], 1e-3), [0, 1, 2, 3, 2, 1]);
}

#[test]
fn weld_takes_positions_and_data_there_and_back() {
    let positions = [A, B, C, B, [-0.0, 0.0, 0.0], D];
    let faces = vec![[0, 1, 2], [3, 4, 5]];
    let description = MeshDescription {
        num_vertices: 6,
        faces: faces.clone(),
        masses_kg: Some(vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0]),
        pins: vec![4, 0],
        body: vec![0, 1, 2, 3, 4, 5],
        layers: Some(vec![0, 1, 2, 3, 4, 5]),
        rest_positions: Some(positions.to_vec()),
        uvs: Some(crate::mesh::Uvs { coordinates: vec![[0.0; 2]; 6], corners: faces }),
    };
    let weld = Weld::find(&description, &positions, &[], 0.0).unwrap();
    let welded = weld.describe(&description);
    assert_eq!((welded.num_vertices, welded.faces), (4, vec![[0, 1, 2], [1, 0, 3]]));
    assert_eq!((welded.masses_kg, welded.pins), (Some(vec![6.0, 6.0, 3.0, 6.0]), vec![0]));
    assert_eq!(welded.body, [0, 1, 2, 3]);
    assert_eq!((welded.layers, welded.uvs), (Some(vec![0, 1, 2, 5]), description.uvs.clone()));
    assert_eq!(weld.copies(VertexId(1)), [1, 3]);
    let mut places = weld.gather(&positions);
    assert_eq!(places, [A, B, C, D]);
    places[1] = [1.5, 0.25, 0.125];
    let moved = weld.scatter(&positions, &places);
    assert_eq!((moved[1], moved[3]), (places[1], places[1]));
    // What did not move keeps its bits, the sign of a zero included.
    assert!(moved[4][0].is_sign_negative() && moved[0][0].is_sign_positive());

    let near = [A, B, C, [1.0, 0.0, 2e-4], [0.0, 1e-4, 0.0], D];
    let weld = Weld::find(&description, &near, &[], 1e-3).unwrap();
    let mut places = weld.gather(&near);
    assert_eq!(places[1], [1.0, 0.0, 1e-4]);
    places[1][0] += 0.5;
    let moved = weld.scatter(&near, &places);
    assert_eq!((moved[1], moved[3], moved[4]), ([1.5, 0.0, 0.0], [1.5, 0.0, 2e-4], near[4]));
}

#[test]
fn weld_of_bad_input_says_what_is_wrong() {
    let description = describe(3, &[[0, 1, 2]]);
    let error = |positions: &[[f64; 3]], distance_m| Weld::find(&description, positions, &[], distance_m).unwrap_err();
    assert_eq!(error(&[A, B], 0.0), WeldError::Length { given: 2, expected: 3 });
    assert_eq!(error(&[A, B, C], -1.0), WeldError::Distance(-1.0));
    assert_eq!(error(&[A, B, C], f64::INFINITY), WeldError::Distance(f64::INFINITY));
    let faulty = describe(3, &[[0, 1, 7]]);
    assert!(matches!(Weld::find(&faulty, &[A, B, C], &[], 0.0), Err(WeldError::Mesh(_))));
}

#[test]
fn weld_joins_no_vertex_of_a_body_with_one_of_a_cloth() {
    let positions = [A, B, C, A, B, D];
    let cloth = describe(6, &[[0, 1, 2], [3, 4, 5]]);
    assert_eq!(Weld::find(&cloth, &positions, &[], 0.0).unwrap().num_merged(), 2);
    let with_body = MeshDescription { body: vec![3, 4, 5], ..cloth };
    for distance_m in [0.0, 1e-6] {
        assert_eq!(Weld::find(&with_body, &positions, &[], distance_m).unwrap().num_merged(), 0);
    }
}
