//! Vertices of many triangles.

use std::f64::consts::TAU;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::{
    Point, crossings, edge_face_hits,
    groups::Groups,
    tree::{Next, Tree},
};

/// The number of pairs of triangles that are looked at.
fn num_visited(positions: &[Point], triangles: &[[u32; 3]]) -> usize {
    let (mut num, mut groups) = (0, Groups::default());
    Tree::new(positions, triangles, &groups).pairs(&mut groups, &mut |_, _| {
        num += 1;
        Next::GoOn
    });
    num
}

/// Triangles round vertex 0, one beside the other, in so many turns about the vertical axis.
fn wheel(num: u32, turns: f64, mut place: impl FnMut(f64) -> Point) -> (Vec<Point>, Vec<[u32; 3]>) {
    let rim = (0..=num).map(|k| place(TAU * turns * f64::from(k) / f64::from(num)));
    let positions = std::iter::once([0.0; 3]).chain(rim).collect();
    (positions, (1..=num).map(|k| [0, k, k + 1]).collect())
}

#[test]
fn crossings_round_a_hub_are_those_of_all_pairs() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let (positions, triangles) = wheel(150, 2.0, |angle| {
        let radius = rng.random_range(0.5..1.5);
        [radius * angle.cos(), radius * angle.sin(), rng.random_range(-0.2..0.2)]
    });
    let alone = |i: usize, j: usize| [triangles[i], triangles[j]];
    let all_pairs = (0..triangles.len()).flat_map(|j| (0..j).map(move |i| (i, j)));
    let (mut pairs, mut num_hits) = (Vec::new(), 0);
    for (i, j) in all_pairs {
        if !crossings(&positions, &alone(i, j)).unwrap().pairs.is_empty() {
            pairs.push([u32::try_from(i).unwrap(), u32::try_from(j).unwrap()]);
        }
        num_hits += edge_face_hits(&positions, &alone(i, j)).unwrap().len();
    }
    pairs.sort_unstable();
    assert!(pairs.len() > 20, "{}", pairs.len());
    assert_eq!(crossings(&positions, &triangles).unwrap().pairs, pairs);
    // No two triangles have the side opposite to the hub in common, so that no hit is found twice.
    assert_eq!(edge_face_hits(&positions, &triangles).unwrap().len(), num_hits);
}

#[test]
fn pairs_round_a_hub_are_few() {
    for height in [0.0, 0.3] {
        let place = |angle: f64| [angle.cos(), angle.sin(), height * (7.0 * angle).sin()];
        let (positions, triangles) = wheel(20_000, 1.0, place);
        let num = num_visited(&positions, &triangles);
        assert!(num < 20 * triangles.len(), "{num} pairs of {} triangles", triangles.len());
    }
}

#[test]
fn pairs_round_a_hub_with_small_triangles_between_are_few() {
    let place = |angle: f64| [angle.cos(), angle.sin(), 0.0];
    let (mut positions, mut triangles) = wheel(4_000, 1.0, place);
    // A tooth on each side of the rim.
    for k in 1..=4_000 {
        let angle = TAU * (f64::from(k) - 0.5) / 4_000.0;
        triangles.push([k + 1, k, u32::try_from(positions.len()).unwrap()]);
        positions.push([1.2 * angle.cos(), 1.2 * angle.sin(), 0.0]);
    }
    let num = num_visited(&positions, &triangles);
    assert!(num < 40 * triangles.len(), "{num} pairs of {} triangles", triangles.len());
}

#[test]
fn pairs_of_a_polygon_cut_from_one_corner_are_few() {
    let n = 10_000_u32;
    let positions: Vec<Point> = (0..n)
        .map(|k| {
            let angle = TAU * f64::from(k) / f64::from(n);
            [angle.cos(), angle.sin(), 0.3 * angle.cos()]
        })
        .collect();
    let triangles: Vec<[u32; 3]> = (1..n - 1).map(|k| [0, k, k + 1]).collect();
    let num = num_visited(&positions, &triangles);
    assert!(num < 20 * triangles.len(), "{num} pairs of {} triangles", triangles.len());
}
