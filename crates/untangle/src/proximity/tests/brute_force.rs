//! The search against a loop over all pairs of primitives.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::{
    frame::Frame,
    mesh::{Mesh, MeshDescription},
    proximity::{Primitives, ProximityEnd, ProximityPair, ProximitySearch},
};

/// All pairs of primitives without a common vertex.
pub(super) fn all_pairs(mesh: &Mesh) -> Vec<Primitives> {
    let mut pairs = Vec::new();
    let used = |face: &_| mesh.face_edges(*face).is_some();
    for vertex in mesh.vertex_ids().filter(|&vertex| !mesh.vertex_faces(vertex).is_empty()) {
        for face in mesh.face_ids().filter(used).filter(|&face| !mesh.face(face).contains(&vertex)) {
            pairs.push(Primitives::VertexFace { vertex, face });
        }
    }
    for first in mesh.edge_ids() {
        for second in mesh.edge_ids().filter(|&second| second > first) {
            if mesh.edge(first).iter().all(|end| !mesh.edge(second).contains(end)) {
                pairs.push(Primitives::EdgeEdge { edges: [first, second] });
            }
        }
    }
    pairs
}

/// A bent grid, and loose triangles over it. A face with a repeated vertex and a vertex of no face are among them.
fn scene(seed: u64, scale: f64, offset: f64) -> (Mesh, Frame) {
    scene_with_bodies(seed, scale, offset, 0)
}

/// The same, so many of the loose triangles being bodies.
fn scene_with_bodies(seed: u64, scale: f64, offset: f64, num_bodies: u32) -> (Mesh, Frame) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    let size = 6_u32;
    for y in 0..=size {
        for x in 0..=size {
            let (x, y) = (f64::from(x), f64::from(y));
            positions.push([x, y, 0.3 * (x * 0.9).sin() + random.random_range(-0.05..0.05)]);
        }
    }
    for y in 0..size {
        for x in 0..size {
            let at = y * (size + 1) + x;
            faces.extend([[at, at + 1, at + size + 2], [at, at + size + 2, at + size + 1]]);
        }
    }
    for _ in 0..25 {
        let first = u32::try_from(positions.len()).unwrap();
        let at: [f64; 3] = std::array::from_fn(|axis| random.random_range(0.0..[6.0, 6.0, 1.0][axis]));
        for _ in 0..3 {
            positions.push(std::array::from_fn(|axis| at[axis] + random.random_range(-0.6..0.6)));
        }
        faces.push([first, first + 1, first + 2]);
    }
    faces.push([0, 0, 1]);
    positions.push([3.0, 3.0, 0.31]);
    for value in positions.as_flattened_mut() {
        *value = *value * scale + offset;
    }
    let first = (size + 1) * (size + 1);
    let body = (first..first + 3 * num_bodies).collect();
    let description = MeshDescription { num_vertices: positions.len(), faces, body, ..Default::default() };
    let mesh = Mesh::new(description).unwrap();
    let frame = Frame::new(&mesh, &positions).unwrap();
    (mesh, frame)
}

#[test]
fn find_gives_the_pairs_of_a_loop_over_all_at_every_scale_and_distance() {
    let mut search = ProximitySearch::default();
    let mut found = Vec::new();
    for (seed, scale, offset) in [(1, 1.0, 0.0), (2, 1e-6, 0.0), (3, 1e6, 0.0), (4, 1.0, 1e6)] {
        let (mesh, frame) = scene(seed, scale, offset);
        let all = all_pairs(&mesh);
        for distance_m in [0.01, 0.1, 0.5, 1.0, 3.0, 100.0].map(|distance| distance * scale) {
            let end = search.find(&mesh, &frame, distance_m, usize::MAX, &mut found);
            assert_eq!(end, ProximityEnd::Complete);
            let expected: Vec<Primitives> =
                all.iter().copied().filter(|pair| pair.are_nearer(&mesh, &frame, distance_m)).collect();
            let pairs: Vec<Primitives> = found.iter().map(|pair| pair.primitives).collect();
            let mut sorted = expected.clone();
            sorted.sort_unstable();
            assert_eq!(pairs, sorted, "seed {seed}, distance {distance_m:e}");
            assert!(found.iter().all(|pair| pair.distance_m < distance_m));
        }
        assert_eq!(found.len(), all.len());
        let limited = search.find(&mesh, &frame, 100.0 * scale, all.len() - 1, &mut found);
        assert_eq!((limited, found.len()), (ProximityEnd::TooManyPairs, 0));
    }
}

#[test]
fn find_and_nearest_with_bodies_leave_out_pairs_of_two() {
    for (seed, num_bodies) in [(1, 1), (2, 12), (3, 25)] {
        let (mesh, frame) = scene_with_bodies(seed, 1.0, 0.0, num_bodies);
        let has_cloth = |pair: &Primitives| pair.vertices(&mesh).any(|vertex| !mesh.is_body(vertex));
        let all: Vec<Primitives> = all_pairs(&mesh).into_iter().filter(has_cloth).collect();
        let mut found = Vec::new();
        let mut search = ProximitySearch::default();
        search.find(&mesh, &frame, 0.5, usize::MAX, &mut found);
        assert_eq!(found.len(), all.iter().filter(|pair| pair.are_nearer(&mesh, &frame, 0.5)).count());
        let least = all.iter().map(|pair| pair.distance_m(&mesh, &frame)).fold(f64::INFINITY, f64::min);
        assert_eq!(search.nearest(&mesh, &frame).unwrap().distance_m.to_bits(), least.to_bits());
    }
}

#[test]
fn nearest_is_the_least_distance_of_a_loop_over_all() {
    let mut search = ProximitySearch::default();
    for seed in 0..20 {
        let (mesh, frame) = scene(seed, 0.37, -5.0);
        let key = |primitives: Primitives| (primitives.distance_m(&mesh, &frame), primitives);
        let least = all_pairs(&mesh).into_iter().map(key).min_by(|a, b| a.partial_cmp(b).unwrap()).unwrap();
        let expected = ProximityPair { primitives: least.1, distance_m: least.0 };
        assert_eq!(search.nearest(&mesh, &frame), Some(expected), "seed {seed}");
    }
}

#[test]
fn nearest_of_one_face_or_of_an_ignored_one_is_none() {
    for faces in [vec![[0, 1, 2]], vec![[0, 1, 2], [0, 0, 3]]] {
        let mesh = Mesh::new(MeshDescription { num_vertices: 4, faces, ..Default::default() }).unwrap();
        let frame = Frame::new(&mesh, &[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.1, 0.1, 0.1]]).unwrap();
        let mut found = Vec::new();
        let mut search = ProximitySearch::default();
        assert_eq!(search.nearest(&mesh, &frame), None);
        assert_eq!(search.find(&mesh, &frame, 9.0, 9, &mut found), ProximityEnd::Complete);
        assert!(found.is_empty());
    }
}

#[test]
fn find_with_a_vertex_far_away_misses_none() {
    for far in [1e4, 1e9, 1e60] {
        let (mesh, frame) = scene(9, 1.0, 0.0);
        let mut positions: Vec<[f64; 3]> = frame.positions().iter().map(|point| (*point).into()).collect();
        positions[52] = [far, far, -far];
        let frame = Frame::new(&mesh, &positions).unwrap();
        let mut found = Vec::new();
        ProximitySearch::default().find(&mesh, &frame, 0.5, usize::MAX, &mut found);
        let expected = all_pairs(&mesh).into_iter().filter(|pair| pair.are_nearer(&mesh, &frame, 0.5)).count();
        assert_eq!(found.len(), expected, "{far:e}");
        let pairs = all_pairs(&mesh);
        let least = pairs.iter().map(|pair| pair.distance_m(&mesh, &frame)).fold(f64::INFINITY, f64::min);
        assert_eq!(ProximitySearch::default().nearest(&mesh, &frame).unwrap().distance_m.to_bits(), least.to_bits());
    }
}

#[test]
fn find_beyond_the_range_of_single_precision_misses_none() {
    // In units of the others the far vertex, and the distance, are too large for single precision.
    let (mesh, frame) = scene(9, 1e-10, 0.0);
    let mut positions: Vec<[f64; 3]> = frame.positions().iter().map(|point| (*point).into()).collect();
    positions[52] = [9e29, 0.0, 0.0];
    let frame = Frame::new(&mesh, &positions).unwrap();
    for distance_m in [1e30, 8e29] {
        let mut found = Vec::new();
        ProximitySearch::default().find(&mesh, &frame, distance_m, usize::MAX, &mut found);
        let is_nearer = |pair: &Primitives| pair.are_nearer(&mesh, &frame, distance_m);
        let expected = all_pairs(&mesh).into_iter().filter(is_nearer).count();
        assert_eq!(found.len(), expected, "{distance_m:e}");
    }
}
