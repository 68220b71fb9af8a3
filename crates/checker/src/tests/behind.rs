//! Vertices behind a layer.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::{Point, vertices_behind, vertices_behind_layers};

/// A tent with four sides over a square, whose faces point upwards.
fn tent() -> (Vec<Point>, Vec<[u32; 3]>) {
    let positions = vec![[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    (positions, vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])
}

#[test]
fn vertices_behind_a_tent_are_those_below_it_at_faces_edges_and_its_top_and_none_beyond_its_hem() {
    let (mut positions, faces) = tent();
    let above = [[0.0, 0.0, 1.1], [0.0, -0.6, 0.6], [0.52, 0.52, 0.6], [0.0, 0.0, 4.0]];
    let below = [[0.0, 0.0, 0.9], [0.0, -0.4, 0.4], [0.5, 0.5, 0.4], [0.0, 0.0, 0.5]];
    let beyond = [[0.0, -1.5, -0.2], [1.4, 1.4, -0.1], [0.0, 0.0, -3.0]];
    let first = u32::try_from(positions.len()).unwrap();
    positions.extend(above.iter().chain(&below).chain(&beyond));
    let vertices = first..u32::try_from(positions.len()).unwrap();
    let expected: Vec<u32> = (first + 4..first + 8).collect();
    assert_eq!(vertices_behind(&positions, vertices.clone(), &faces, 1.0).unwrap(), expected);
    // Turned round, the other side is behind; what is out of reach is not over it.
    let turned: Vec<[u32; 3]> = faces.iter().map(|&[a, b, c]| [a, c, b]).collect();
    let expected: Vec<u32> = (first..first + 3).collect();
    assert_eq!(vertices_behind(&positions, vertices, &turned, 1.0).unwrap(), expected);
}

/// A rough field of heights over the unit square, and the height of it at a place.
fn field(rng: &mut ChaCha8Rng, size: u32) -> (Vec<Point>, Vec<[u32; 3]>, impl Fn(f64, f64) -> f64 + use<>) {
    let steps = f64::from(size);
    let heights: Vec<f64> = (0..(size + 1).pow(2)).map(|_| rng.random_range(-0.05..0.05)).collect();
    let positions = (0..)
        .zip(&heights)
        .map(|(index, height)| [f64::from(index % (size + 1)) / steps, f64::from(index / (size + 1)) / steps, *height]);
    let positions: Vec<Point> = positions.collect();
    let cell = move |index: u32| index / size * (size + 1) + index % size;
    let two = |first: u32| [[first, first + 1, first + size + 2], [first, first + size + 2, first + size + 1]];
    let faces = (0..size * size).flat_map(|index| two(cell(index))).collect();
    let height = move |x: f64, y: f64| {
        let (column, row) = ((x * steps).floor(), (y * steps).floor());
        let (u, v) = (x * steps - column, y * steps - row);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small positive number")]
        let at = |i: f64, j: f64| heights[((row + j) * (steps + 1.0) + column + i) as usize];
        let corner = if u > v { at(1.0, 0.0) } else { at(0.0, 1.0) };
        let (first, last) = (at(0.0, 0.0), at(1.0, 1.0));
        first * (1.0 - u.max(v)) + corner * (u - v).abs() + last * u.min(v)
    };
    (positions, faces, height)
}

#[test]
fn vertices_behind_a_rough_field_are_those_below_it_at_any_size() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    for size in [1, 3, 20, 60] {
        let (mut positions, faces, height) = field(&mut rng, size);
        let first = u32::try_from(positions.len()).unwrap();
        let mut expected = Vec::new();
        for vertex in first..first + 2000 {
            let [x, y] = [0, 1].map(|_| rng.random_range(0.2..0.8));
            let z = rng.random_range(-0.1..0.1);
            positions.push([x, y, z]);
            expected.extend((z < height(x, y)).then_some(vertex));
        }
        let vertices = first..first + 2000;
        assert_eq!(vertices_behind(&positions, vertices, &faces, 1.0).unwrap(), expected, "{size}");
        assert!(expected.len() > 500 && expected.len() < 1500);
    }
}

#[test]
fn vertices_behind_layers_are_those_of_later_layers_each_once_within_a_tenth_of_the_inner_one() {
    // Three squares over each other, from the innermost outwards: the others are below it, the third one the lowest.
    let heights = [0.0, -0.05, -0.1, 0.5];
    let mut positions = Vec::new();
    let mut faces: Vec<[u32; 3]> = Vec::new();
    for (layer, height) in (0..).zip(heights) {
        // The outer ones lie over the inside of the innermost.
        let margin = if layer == 0 { 0.0 } else { 0.2 };
        let [low, high] = [margin, 1.0 - margin];
        positions.extend([[low, low, height], [high, low, height], [high, high, height], [low, high, height]]);
        faces.extend([[0, 1, 2], [0, 2, 3]].map(|face| face.map(|corner: u32| corner + 4 * layer)));
    }
    let numbers: Vec<u32> = (0..16).map(|vertex| vertex / 4).collect();
    let behind = |are_outwards: &[bool]| vertices_behind_layers(&positions, &faces, &numbers, are_outwards).unwrap();
    assert_eq!(behind(&[true; 8]), (4..12).collect::<Vec<u32>>());
    assert_eq!(behind(&[false; 8]), [0_u32; 0]);
    // In one layer nothing has an order.
    assert_eq!(vertices_behind_layers(&positions, &faces, &[0; 16], &[true; 8]).unwrap(), [0_u32; 0]);
}
