use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::{CheckError, Point, count_edge_face, edge_face_hits, face_pairs, primitive::segment_meets_triangle};

const TRIANGLE: [Point; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

fn meets(p: Point, q: Point) -> bool {
    let answer = segment_meets_triangle([p, q], TRIANGLE);
    let [a, b, c] = TRIANGLE;
    for triangle in [[b, c, a], [c, b, a]] {
        assert_eq!(segment_meets_triangle([q, p], triangle), answer, "the order of vertices changed the answer");
    }
    answer
}

#[test]
fn segment_meets_triangle_only_when_it_passes_through() {
    assert!(meets([0.2, 0.2, -1.0], [0.2, 0.2, 1.0]));
    assert!(!meets([0.8, 0.8, -1.0], [0.8, 0.8, 1.0]));
    assert!(!meets([0.2, 0.2, 1e-300], [0.2, 0.2, 1.0]));
    assert!(!meets([0.2, 0.2, 1.0], [0.9, 0.2, 2.0]));
}

#[test]
fn segment_meets_triangle_when_it_touches_any_feature() {
    let below = [0.3, 0.3, -1.0];
    for on in [[0.2, 0.2, 0.0], [0.5, 0.0, 0.0], [0.5, 0.5, 0.0], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0]] {
        assert!(meets(below, on), "ends in {on:?}");
        assert!(meets([on[0], on[1], -1.0], [on[0], on[1], 1.0]), "passes {on:?}");
        let off = [on[0] - 2e-16, on[1] - 2e-16, 0.0];
        let inside = off[0] >= 0.0 && off[1] >= 0.0;
        assert_eq!(meets([off[0], off[1], -1.0], [off[0], off[1], 1.0]), inside, "passes {off:?}");
    }
}

#[test]
fn segment_meets_triangle_decides_coplanar_segments_in_the_plane() {
    assert!(meets([0.1, 0.1, 0.0], [0.2, 0.2, 0.0]), "inside");
    assert!(meets([-1.0, 0.2, 0.0], [2.0, 0.2, 0.0]), "across");
    assert!(meets([-1.0, 0.0, 0.0], [0.0, 0.0, 0.0]), "ends in a corner");
    assert!(meets([0.5, 0.0, 0.0], [3.0, 0.0, 0.0]), "overlaps a side");
    assert!(!meets([1.5, 0.0, 0.0], [3.0, 0.0, 0.0]), "beyond a side on its line");
    assert!(!meets([1.0, 1.0, 0.0], [2.0, 0.0, 0.0]), "beside");
}

#[test]
fn segment_meets_triangle_takes_degenerate_triangles_as_point_sets() {
    let needle = [[0.0, 0.0, 0.0], [1.0, 1.0, 1.0], [2.0, 2.0, 2.0]];
    assert!(segment_meets_triangle([[1.5, 1.5, 0.0], [1.5, 1.5, 2.0]], needle));
    assert!(!segment_meets_triangle([[1.5, 1.4, 0.0], [1.5, 1.4, 2.0]], needle));
    assert!(segment_meets_triangle([[1.5, 1.5, 1.5], [3.0, 3.0, 3.0]], needle));
    assert!(!segment_meets_triangle([[2.5, 2.5, 2.5], [3.0, 3.0, 3.0]], needle));
    let point = [[0.25, 0.25, 0.0]; 3];
    assert!(segment_meets_triangle([[0.0, 0.25, 0.0], [1.0, 0.25, 0.0]], point));
    assert!(!segment_meets_triangle([[0.0, 0.5, 0.0], [1.0, 0.5, 0.0]], point));
    assert!(meets([0.25, 0.25, 0.0], [0.25, 0.25, 0.0]));
}

#[test]
fn count_edge_face_of_bad_input_names_vertex_or_triangle() {
    let nan = [[0.0; 3], [0.0, f64::NAN, 0.0], [1.0; 3]];
    assert_eq!(count_edge_face(&nan, &[[0, 1, 2]]), Err(CheckError::NotFinite(1)));
    let expected = CheckError::Index { triangle: 0, vertex: 7, num_vertices: 3 };
    assert_eq!(count_edge_face(&TRIANGLE, &[[0, 1, 7]]), Err(expected));
}

fn unique_edges(triangles: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let mut edges: Vec<[u32; 2]> = triangles
        .iter()
        .flat_map(|&[a, b, c]| [[a.min(b), a.max(b)], [b.min(c), b.max(c)], [c.min(a), c.max(a)]])
        .collect();
    edges.sort_unstable();
    edges.dedup();
    edges
}

#[test]
fn edge_face_hits_equal_brute_force_on_a_lattice() {
    let mut found = 0;
    for seed in 0..20 {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        // Coordinates on a coarse lattice, so that all the degenerate cases occur.
        let positions: Vec<Point> =
            (0..40).map(|_| std::array::from_fn(|_| f64::from(rng.random_range(0..12_i32)) * 0.25)).collect();
        let triangles: Vec<[u32; 3]> = (0..30).map(|_| std::array::from_fn(|_| rng.random_range(0..40_u32))).collect();
        let mut brute = Vec::new();
        for edge in unique_edges(&triangles) {
            for (index, triangle) in (0..).zip(&triangles) {
                let at = |vertex: u32| positions[vertex as usize];
                if !edge.iter().any(|vertex| triangle.contains(vertex))
                    && segment_meets_triangle(edge.map(at), triangle.map(at))
                {
                    brute.push((edge, index));
                }
            }
        }
        brute.sort_unstable();
        let swept: Vec<_> =
            edge_face_hits(&positions, &triangles).unwrap().iter().map(|hit| (hit.edge, hit.triangle)).collect();
        assert_eq!(swept, brute, "seed {seed}");
        found += brute.len();
    }
    assert!(found > 500, "only {found} hits: the test shows nothing");
}

#[test]
fn face_pairs_count_triangles_that_share_a_vertex_and_cross() {
    let positions = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [1.0, 0.2, -1.0], [0.2, 1.0, 1.0]];
    let triangles = [[0, 1, 2], [0, 3, 4]];
    let hits = edge_face_hits(&positions, &triangles).unwrap();
    assert_eq!(hits.len(), 1);
    assert_eq!(face_pairs(&hits, &triangles), [[0, 1]]);
}
