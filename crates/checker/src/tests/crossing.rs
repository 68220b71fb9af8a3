use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::{Point, PolygonRef, crossings, fan_crossings};

fn pairs(positions: &[Point], triangles: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let found = crossings(positions, triangles).unwrap();
    assert!(found.is_complete);
    found.pairs
}

type Whole = [i128; 3];

fn minus(a: Whole, b: Whole) -> Whole {
    [0, 1, 2].map(|axis| a[axis] - b[axis])
}

fn dot(a: Whole, b: Whole) -> i128 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Whole, b: Whole) -> Whole {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn normal([a, b, c]: [Whole; 3]) -> Whole {
    cross(minus(b, a), minus(c, a))
}

/// The open interval of the line with direction `along` that a triangle cuts out of the plane of another one, as
/// fractions with positive denominators.
fn interval(own: [Whole; 3], plane: [Whole; 3], along: Whole) -> Option<[(i128, i128); 2]> {
    let heights = own.map(|corner| dot(normal(plane), minus(corner, plane[0])));
    if heights.iter().all(|&h| h >= 0) || heights.iter().all(|&h| h <= 0) {
        return None;
    }
    let mut ends: Vec<(i128, i128)> = Vec::new();
    for k in 0..3 {
        let (h, next) = (heights[k], heights[(k + 1) % 3]);
        if h == 0 {
            ends.push((dot(own[k], along), 1));
        } else if h * next < 0 {
            let number = dot(own[(k + 1) % 3], along) * h - dot(own[k], along) * next;
            ends.push(if h > next { (number, h - next) } else { (-number, next - h) });
        }
    }
    ends.sort_by(|a, b| (a.0 * b.1).cmp(&(b.0 * a.1)));
    Some([ends[0], ends[ends.len() - 1]])
}

/// Whether the interiors of two triangles of whole coordinates cross, in whole numbers.
fn brute_force(first: [Whole; 3], second: [Whole; 3]) -> bool {
    let along = cross(normal(first), normal(second));
    let (Some([a, b]), Some([c, d])) = (interval(first, second, along), interval(second, first, along)) else {
        return false;
    };
    let less = |p: (i128, i128), q: (i128, i128)| p.0 * q.1 < q.0 * p.1;
    less(a, d) && less(c, b)
}

#[test]
fn crossings_of_a_soup_on_a_lattice_contain_those_of_interiors_in_whole_numbers() {
    let mut found = 0;
    for seed in 0..30 {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let whole: Vec<Whole> =
            (0..30).map(|_| std::array::from_fn(|_| i128::from(rng.random_range(0..6_i32)))).collect();
        #[expect(clippy::cast_precision_loss, reason = "small whole numbers")]
        let positions: Vec<Point> = whole.iter().map(|point| point.map(|value| value as f64)).collect();
        let triangles: Vec<[u32; 3]> = (0..30).map(|_| std::array::from_fn(|_| rng.random_range(0..30_u32))).collect();
        let reported = pairs(&positions, &triangles);
        for (i, first) in (0..).zip(&triangles) {
            for (j, second) in (0..).zip(&triangles).skip(i as usize + 1) {
                let at = |vertex: u32| whole[vertex as usize];
                let common = first.iter().filter(|vertex| second.contains(vertex)).count();
                let expected = common < 2 && brute_force(first.map(at), second.map(at));
                found += usize::from(expected);
                // A pair that is reported beyond these crosses along an edge: both planes hold an edge then.
                if expected {
                    assert!(reported.contains(&[i, j]), "seed {seed}: {first:?} {second:?}");
                }
            }
        }
        let alone: Vec<[u32; 2]> = reported
            .iter()
            .copied()
            .filter(|pair| {
                let [first, second] = pair.map(|index| triangles[index as usize].map(|v| whole[v as usize]));
                !brute_force(first, second)
            })
            .collect();
        for [i, j] in alone {
            let [first, second] = [i, j].map(|index| triangles[index as usize].map(|v| whole[v as usize]));
            let on = |own: [Whole; 3], plane: [Whole; 3]| {
                own.iter().filter(|corner| dot(normal(plane), minus(**corner, plane[0])) == 0).count()
            };
            assert!(on(first, second) == 2 || on(second, first) == 2, "seed {seed}: {first:?} {second:?}");
        }
    }
    assert!(found > 300, "only {found} crossings: the test shows nothing");
}

const A: Point = [0.0, 0.0, 0.0];
const B: Point = [1.0, 0.0, 0.0];
const WEST: Point = [0.5, -1.0, 0.0];
const EAST: Point = [0.5, 1.0, 0.0];
const UP: Point = [0.5, 0.0, 1.0];
const DOWN: Point = [0.5, 0.0, -1.0];

#[test]
fn crossings_along_common_edges_are_seen_where_the_sheets_alternate() {
    let faces = [[0, 1, 2], [1, 0, 3], [4, 5, 6], [5, 4, 7]];
    let sheets =
        |first: [Point; 2], second: [Point; 2]| pairs(&[A, B, first[0], first[1], A, B, second[0], second[1]], &faces);
    let all = [[0, 2], [0, 3], [1, 2], [1, 3]];
    assert_eq!(sheets([WEST, EAST], [UP, DOWN]), all);
    // Folds that touch along the edge, one beside the other, and one within the other.
    let high_west = [0.5, -0.5, 1.0];
    assert_eq!(sheets([WEST, EAST], [UP, high_west]), [[0_u32; 2]; 0]);
    assert_eq!(sheets([WEST, UP], [EAST, DOWN]), [[0_u32; 2]; 0]);
    assert_eq!(sheets([UP, DOWN], [WEST, high_west]), [[0_u32; 2]; 0]);
    // Those in one plane cross nothing, but their neighbours do.
    assert_eq!(sheets([UP, WEST], [high_west, DOWN]), [[0, 2], [1, 2], [1, 3]]);
    // A pocket: a boundary on an edge.
    assert_eq!(pairs(&[A, B, WEST, EAST, A, B, UP], &faces[..3]), [[0_u32; 2]; 0]);
}

#[test]
fn crossings_of_an_edge_in_the_plane_of_a_triangle_need_wings_on_both_sides() {
    let floor = [[-2.0, -3.0, 0.0], [4.0, -3.0, 0.0], [0.5, 4.0, 0.0]];
    let with = |wings: &[Point]| {
        let positions = [&floor[..], &[A, B], wings].concat();
        let faces: Vec<[u32; 3]> =
            std::iter::once([0, 1, 2]).chain((5..).take(wings.len()).map(|v| [3, 4, v])).collect();
        pairs(&positions, &faces)
    };
    assert_eq!(with(&[UP, DOWN]), [[0, 1], [0, 2]]);
    assert_eq!(with(&[UP]), [[0_u32; 2]; 0]);
    assert_eq!(with(&[UP, [0.5, 1.0, 1.0]]), [[0_u32; 2]; 0]);
}

#[test]
fn crossings_of_triangles_that_touch_are_none() {
    let floor = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
    let with = |other: [Point; 3]| pairs(&[floor, other].concat(), &[[0, 1, 2], [3, 4, 5]]);
    let standing = |foot: Point| [foot, [1.0, 1.0, 1.0], [2.0, 1.0, 1.0]];
    for foot in [[1.0, 1.0, 0.0], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0]] {
        assert_eq!(with(standing(foot)), [[0_u32; 2]; 0], "{foot:?}");
    }
    assert_eq!(with(floor), [[0_u32; 2]; 0], "lies on it");
    assert_eq!(with(standing([1.0, 1.0, -1e-300])), [[0, 1]]);
    // One common vertex, and a crossing that begins there.
    let positions = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [1.0, 0.2, -1.0], [0.2, 1.0, 1.0]];
    assert_eq!(pairs(&positions, &[[0, 1, 2], [0, 3, 4]]), [[0, 1]]);
}

#[test]
fn fan_crossings_see_what_another_diagonal_brings() {
    // A quad bent along its diagonal 0 2, and a spike between that and the other diagonal.
    let positions = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 1.0],
        [1.0, 1.0, 0.0],
        [0.0, 1.0, 1.0],
        [0.5, 0.5, 1.5],
        [0.6, 0.5, 3.0],
        [0.5, 0.6, 3.0],
    ];
    let spike: &[u32] = &[4, 5, 6];
    let quad: &[u32] = &[0, 1, 2, 3];
    let own = [[0, 1, 2], [0, 2, 3], [4, 5, 6]];
    assert_eq!(pairs(&positions, &own), [[0_u32; 2]; 0]);
    let polygons = [
        PolygonRef { corners: quad, triangles: &own[..2], is_body: false },
        PolygonRef { corners: spike, triangles: &own[2..], is_body: false },
    ];
    let mut low = positions;
    low[4][2] = 0.5;
    assert_eq!(fan_crossings(&positions, polygons).unwrap().pairs, [[0_u32; 2]; 0]);
    assert_eq!(pairs(&low, &own), [[0_u32; 2]; 0]);
    assert_eq!(fan_crossings(&low, polygons).unwrap().pairs, [[0, 1]]);
}

#[test]
fn crossings_of_a_cloth_that_is_all_tangle_end_at_a_limit() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let positions: Vec<Point> = (0..9000).map(|_| std::array::from_fn(|_| rng.random::<f64>())).collect();
    let triangles: Vec<[u32; 3]> = (0..3000).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    let found = crossings(&positions, &triangles).unwrap();
    assert_eq!(found.is_complete, found.pairs.len() < 1_000_000);
    assert!(found.pairs.len() > 100_000);
}
