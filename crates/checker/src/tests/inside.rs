//! Vertices inside of boxes.
#![expect(clippy::float_cmp, reason = "coordinates on a grid")]

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::vertices_inside;

/// Boxes from one corner to the other, and their triangles, which point outwards.
fn boxes(all: &[[[f64; 3]; 2]]) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    for [low, high] in all {
        let first = u32::try_from(positions.len()).unwrap();
        positions.extend((0..8).map(|corner| {
            std::array::from_fn::<f64, 3, _>(|axis| if corner >> axis & 1 == 0 { low[axis] } else { high[axis] })
        }));
        let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        for [a, b, c, d] in sides.map(|side| side.map(|corner| first + corner)) {
            faces.extend([[a, b, c], [a, c, d]]);
        }
    }
    (positions, faces)
}

#[test]
fn vertices_inside_of_overlapping_boxes_are_those_in_one_of_them_on_edges_of_their_faces_too() {
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let all = [[[0.0; 3], [2.0; 3]], [[1.0, 1.0, -1.0], [3.0, 3.0, 1.0]]];
    let (corners, faces) = boxes(&all);
    let mut turned = faces.clone();
    turned[..12].iter_mut().for_each(|face| face.swap(0, 1));
    for body in [faces, turned] {
        let mut positions = corners.clone();
        // Many lie above edges, diagonals and corners.
        positions.extend((0..4000).map(|_| std::array::from_fn(|_| 0.25 * f64::from(random.random_range(-5..14)))));
        let num = u32::try_from(positions.len()).unwrap();
        let found = vertices_inside(&positions, 16..num, &body).unwrap();
        let is_in = |at: [f64; 3]| {
            let within = |[low, high]: &[[f64; 3]; 2]| (0..3).all(|axis| low[axis] < at[axis] && at[axis] < high[axis]);
            all.iter().any(within)
        };
        let is_on = |at: [f64; 3]| {
            all.iter().any(|[low, high]| {
                (0..3).all(|axis| low[axis] <= at[axis] && at[axis] <= high[axis])
                    && (0..3).any(|axis| at[axis] == low[axis] || at[axis] == high[axis])
            })
        };
        for vertex in 16..num {
            let at = positions[vertex as usize];
            // On a vertical side is in or out.
            if !is_on(at) || is_in(at) {
                assert_eq!(found.binary_search(&vertex).is_ok(), is_in(at), "{at:?}");
            }
        }
    }
}

#[test]
fn vertices_inside_of_a_box_with_a_hole_are_those_that_see_more_than_half_of_it() {
    let (mut positions, mut faces) = boxes(&[[[0.0; 3], [1.0; 3]]]);
    // Without its lid.
    faces.retain(|face| face.iter().any(|&corner| corner < 4));
    assert_eq!(faces.len(), 10);
    positions.extend([[0.5, 0.5, 0.2], [0.4, 0.5, 0.95], [0.5, 0.5, 1.5], [0.5, 0.5, -0.1], [5.0, 0.0, 0.0]]);
    assert_eq!(vertices_inside(&positions, 8..13, &faces).unwrap(), [8, 9]);
}
