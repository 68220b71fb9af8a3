//! Vertex stars, whose test passes over most pairs: the search against a loop over all pairs.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::brute_force::all_pairs;
use crate::{
    frame::Frame,
    mesh::{Mesh, MeshDescription},
    proximity::{Primitives, ProximitySearch},
};

/// Fans of so many faces each, far from each other: closed or open, flat to steep, of even and uneven wedges.
fn fans(num_faces: u32, closes: bool, seed: u64) -> (Mesh, Vec<[f64; 3]>) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    // Eight of one kind are tested together.
    for fan in 0..if num_faces > 64 { 2 } else { 12 } {
        let first = u32::try_from(positions.len()).unwrap();
        let (steepness, unevenness) = (f64::from(fan % 4), 0.3 * f64::from(fan % 3));
        let turn = if closes { 1.0 } else { random.random_range(0.3..1.0) };
        let (tilt, offset) = (random.random_range(-1.0..1.0), 50.0 * f64::from(fan));
        let mut push = |[x, y, z]: [f64; 3]| positions.push([x + offset, y - tilt * z, z + tilt * y]);
        push([0.0; 3]);
        let num_spokes = num_faces + u32::from(!closes);
        for spoke in 0..num_spokes {
            let part = (f64::from(spoke) + unevenness * random.random_range(-1.0..1.0)) / f64::from(num_faces);
            let (sine, cosine) = (std::f64::consts::TAU * turn * part).sin_cos();
            let length = 1.0 + unevenness * random.random_range(-1.0..1.0);
            push([length * cosine, length * sine, 0.3 * steepness * random.random_range(-1.0..1.0)]);
        }
        for face in 0..num_faces {
            faces.push([first, first + 1 + face, first + 1 + (face + 1) % num_spokes]);
        }
    }
    (Mesh::new(MeshDescription { num_vertices: positions.len(), faces, ..Default::default() }).unwrap(), positions)
}

#[test]
fn find_round_single_vertices_gives_the_pairs_of_a_loop_over_all() {
    let mut found = Vec::new();
    for (seed, (num_faces, closes)) in (0..).zip([3, 4, 5, 6, 8, 70].into_iter().flat_map(|n| [(n, true), (n, false)]))
    {
        let (mesh, positions) = fans(num_faces, closes, seed);
        let all = all_pairs(&mesh);
        let mut search = ProximitySearch::default();
        for scale in [1.0, 1e-3] {
            let positions: Vec<[f64; 3]> = positions.iter().map(|place| place.map(|value| value * scale)).collect();
            let frame = Frame::new(&mesh, &positions).unwrap();
            let mut counts = Vec::new();
            for distance_m in [0.02, 0.1, 0.2, 0.4, 0.6, 0.8].map(|distance| distance * scale) {
                search.find(&mesh, &frame, distance_m, usize::MAX, &mut found);
                let mut expected: Vec<Primitives> =
                    all.iter().copied().filter(|pair| pair.are_nearer(&mesh, &frame, distance_m)).collect();
                expected.sort_unstable();
                let pairs: Vec<Primitives> = found.iter().map(|pair| pair.primitives).collect();
                assert!(pairs == expected, "{num_faces} faces, closed {closes}, {distance_m:e}");
                counts.push(pairs.len());
            }
            assert!(counts[5] > counts[0], "{counts:?}");
        }
    }
}
