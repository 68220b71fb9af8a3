//! Polygons of many corners.

use std::f64::consts::TAU;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::{
    Point, PolygonRef, crossings, fan_crossings,
    groups::Groups,
    polygon_crossings,
    tree::{Next, Tree},
};

/// A ragged star in the plane z = slope x, as a polygon of `num` corners about the origin and its triangles from a
/// vertex in the middle, which is the last one.
fn star(num: u32, slope: f64) -> (Vec<Point>, Vec<u32>, Vec<[u32; 3]>) {
    let mut rng = ChaCha8Rng::seed_from_u64(8);
    let corner = |k: u32| {
        let (angle, radius) = (TAU * f64::from(k) / f64::from(num), rng.random_range(0.5..1.0));
        let x = radius * angle.cos();
        [x, radius * angle.sin(), slope * x]
    };
    let positions = (0..num).map(corner).chain([[0.0; 3]]).collect();
    (positions, (0..num).collect(), (0..num).map(|k| [k, (k + 1) % num, num]).collect())
}

#[test]
fn pairs_of_a_flat_polygon_of_many_corners_are_not_visited() {
    let (positions, corners, _) = star(4_000, 0.5);
    let fan: Vec<[u32; 3]> = (1..3_999).map(|k| [0, k, k + 1]).collect();
    let mut groups = Groups::default();
    groups.add(&positions, PolygonRef { corners: &corners, triangles: &fan, is_body: false }, fan.len());
    let mut num = 0;
    Tree::new(&positions, &fan, &groups).pairs(&mut groups, &mut |_, _| {
        num += 1;
        Next::GoOn
    });
    assert_eq!(num, 0);
}

#[test]
fn crossings_of_a_flat_polygon_with_another_are_all_found() {
    let (mut positions, corners, own) = star(500, 0.5);
    // A triangle that stands in the star.
    let first = u32::try_from(positions.len()).unwrap();
    positions.extend([[0.1, 0.0, -1.0], [0.2, 0.1, 1.0], [0.15, -0.1, 1.0]]);
    let post = [[first, first + 1, first + 2]];
    let polygons = [
        PolygonRef { corners: &corners, triangles: &own, is_body: false },
        PolygonRef { corners: &post[0], triangles: &post, is_body: false },
    ];
    let all = [&own[..], &post].concat();
    let expected = crossings(&positions, &all).unwrap().pairs;
    assert!(!expected.is_empty());
    assert_eq!(polygon_crossings(&positions, polygons, false).unwrap().pairs, expected);
    assert_eq!(fan_crossings(&positions, polygons).unwrap().pairs, [[0, 1]]);
}

#[test]
fn polygon_crossings_list_one_crossing_of_a_ragged_fan_with_itself() {
    // Rounding lifts corners out of the plane, so that the triangles that cover each other cross.
    let (positions, corners, own) = star(500, 1.0 / 3.0);
    let polygon = [PolygonRef { corners: &corners, triangles: &own, is_body: false }];
    let fan: Vec<[u32; 3]> = (1..499).map(|k| [0, k, k + 1]).collect();
    assert!(crossings(&positions, &fan).unwrap().pairs.len() > 100);
    assert_eq!(polygon_crossings(&positions, polygon, true).unwrap().pairs.len(), 1);
    assert_eq!(polygon_crossings(&positions, polygon, false).unwrap().pairs.len(), 0);
    assert_eq!(fan_crossings(&positions, polygon).unwrap().pairs, [[0, 0]]);
}

#[test]
fn crossings_of_long_triangles_in_nearly_one_plane_are_those_of_the_signs_in_space() {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let mut point = || {
        let [x, y] = [0; 2].map(|_| rng.random_range(-1.0..1.0));
        [x, y, 0.3 * x + rng.random_range(-1e-3..1e-3)]
    };
    let positions: Vec<Point> = (0..600).map(|_| point()).collect();
    let triangles: Vec<[u32; 3]> = (0..200).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    let found = crossings(&positions, &triangles).unwrap().pairs;
    let place = |triangle: u32| triangles[triangle as usize].map(|vertex| positions[vertex as usize]);
    let all = (0..200).flat_map(|j| (0..j).map(move |i| [i, j]));
    let mut expected: Vec<[u32; 2]> =
        all.filter(|pair| crate::crossing::triangles_cross(place(pair[0]), place(pair[1]))).collect();
    expected.sort_unstable();
    assert!(expected.len() > 100, "{}", expected.len());
    assert_eq!(found, expected);
}
