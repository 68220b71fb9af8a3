//! Counts of near pairs.

use crate::{NearPairs, near_pairs};

const FLOOR: [[f64; 3]; 4] = [[0.0; 3], [4.0, 0.0, 0.0], [4.0, 4.0, 0.0], [0.0, 4.0, 0.0]];

fn lid(height: f64) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let mut positions = FLOOR.to_vec();
    positions.extend([[1.0, 1.5, height], [3.0, 1.25, height], [2.0, 3.5, height]]);
    (positions, vec![[0, 1, 2], [0, 2, 3], [4, 5, 6]])
}

#[test]
fn near_pairs_at_exactly_the_distance_do_not_count_and_below_it_do() {
    for height in [0.125, 0.1, 1e-9, 3e-5] {
        let (positions, triangles) = lid(height);
        assert_eq!(near_pairs(&positions, &triangles, triangles.len(), height).unwrap().total(), 0);
        let found = near_pairs(&positions, &triangles, triangles.len(), height.next_up()).unwrap();
        // Each corner over one of the triangles, and the two edges over the diagonal.
        let expected = NearPairs { num_vertex_triangle: 3, num_edge_edge: 2, is_complete: true };
        assert_eq!(found, expected, "{height}");
    }
}

#[test]
fn near_pairs_of_one_surface_are_those_without_a_common_vertex() {
    let triangles = [[0, 1, 2], [0, 2, 3], [1, 1, 3]];
    // Vertices 1 and 3 beside the triangles across, and two pairs of opposite edges.
    let found = near_pairs(&FLOOR, &triangles, triangles.len(), 4.5).unwrap();
    assert_eq!((found.num_vertex_triangle, found.num_edge_edge), (2, 2));
    // They are at 2 sqrt(2) from the diagonal.
    let found = near_pairs(&FLOOR, &triangles, triangles.len(), 2.9).unwrap();
    assert_eq!((found.num_vertex_triangle, found.num_edge_edge), (2, 0));
    assert_eq!(near_pairs(&FLOOR, &triangles, triangles.len(), 2.8).unwrap().total(), 0);
}

#[test]
fn near_pairs_of_degenerate_primitives_and_extreme_sizes_are_ordinary() {
    // A triangle that is a point, and one that is a segment.
    let positions = [[0.0; 3], [0.0; 3], [0.0; 3], [3.0, 4.0, 0.0], [6.0, 8.0, 0.0], [9.0, 12.0, 0.0]];
    let triangles = [[0, 1, 2], [3, 4, 5]];
    for scale in [1.0, 2.0_f64.powi(-260), 2.0_f64.powi(250)] {
        let positions = positions.map(|point| point.map(|value| value * scale));
        assert_eq!(near_pairs(&positions, &triangles, triangles.len(), 5.0 * scale).unwrap().total(), 0);
        let found = near_pairs(&positions, &triangles, triangles.len(), (5.0 * scale).next_up()).unwrap();
        // All of the point with the end of the segment: its corners with the triangle, the end with the point, and
        // three edges with the two that end there.
        assert_eq!((found.num_vertex_triangle, found.num_edge_edge), (4, 6));
    }
}

#[test]
fn near_pairs_of_two_bodies_do_not_count_and_those_with_cloth_do() {
    let (positions, triangles) = lid(0.125);
    let total = |first_body| near_pairs(&positions, &triangles, first_body, 0.2).unwrap().total();
    assert_eq!((total(3), total(2), total(0)), (5, 5, 0));
    // The floor as the cloth: its two triangles have no near pair among themselves.
    let two_bodies = [[4, 5, 6], [0, 1, 2], [0, 2, 3]];
    assert_eq!(near_pairs(&positions, &two_bodies, 1, 0.2).unwrap().total(), 5);
}
