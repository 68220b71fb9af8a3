//! The flattening flow without the plans before it, on a strip that is rolled up.

use std::ops::ControlFlow;

use super::*;
use crate::{
    correspond::samples::sheet_faces,
    mesh::{Mesh, MeshDescription},
    relax::{Iteration, RelaxSettings},
};

/// A strip rolled up so that its second turn goes in and out through its first.
fn roll() -> (MeshDescription, Vec<[f64; 3]>) {
    let (along, across) = (48u32, 8u32);
    let mut positions = Vec::new();
    for row in 0..=across {
        for column in 0..=along {
            let (u, v) = (f64::from(column) / f64::from(along), f64::from(row) / f64::from(across));
            let angle = 11.0 * u;
            let radius = 0.1 + 0.004 * (2.5 * angle).sin() + 0.001 * v;
            positions.push([radius * angle.cos(), radius * angle.sin(), 0.15 * v]);
        }
    }
    let faces = sheet_faces(along, across);
    (MeshDescription { num_vertices: positions.len(), faces, ..Default::default() }, positions)
}

/// Flattens within so many iterations, and interrupts where nothing intersects for the first time if asked. Gives back
/// how it ended, whether the best state is clean, and the number of edge-face intersections after each iteration.
fn flattened(most: usize, interrupt: bool) -> (End, bool, Vec<usize>) {
    let (description, positions) = roll();
    let mesh = Mesh::new(description).unwrap();
    let settings = RelaxSettings { max_iterations: most, ..RelaxSettings::default() };
    let mut relaxer = Relaxer::new(&mesh, &positions, &settings, &|| false).unwrap();
    let input = relaxer.frame.positions().to_vec();
    relaxer.set_frame(&input).unwrap();
    assert!(relaxer.analyser.last().intersections.edge_face.len() > 20);
    let mut best = BestState { merit: f64::INFINITY, positions: input };
    let mut left = Vec::new();
    let mut progress = |step: &Iteration| {
        left.push(step.num_edge_face_intersections);
        if interrupt && step.num_edge_face_intersections == 0 {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    };
    let end = flatten(&mut relaxer, &mut best, &mut progress).unwrap();
    relaxer.set_frame(&best.positions).unwrap();
    (end, relaxer.analyser.last().intersections.edge_face.is_empty(), left)
}

#[test]
fn flatten_stopped_during_recovery_gives_back_clean_state() {
    let (end, clean, left) = flattened(100, false);
    assert!(end == End::Clean && clean, "{end:?} {left:?}");
    let first = left.iter().position(|&left| left == 0).unwrap() + 1;
    assert!(first + 2 < left.len());
    for most in first..left.len() {
        let (end, clean, left) = flattened(most, false);
        assert!(end == End::Clean && clean, "{most} {end:?} {left:?}");
    }
    let (end, clean, _) = flattened(0, false);
    assert!(end == End::Exhausted && !clean, "{end:?}");
    // Interrupted before shape recovery, it gives back the flat state.
    let (end, clean, left) = flattened(100, true);
    assert!(end == End::Interrupted && clean, "{end:?} {left:?}");
}

#[test]
fn least_violated_of_clean_states_keeps_fewest_violations_and_of_equals_the_last() {
    let (description, positions) = roll();
    let mesh = Mesh::new(description).unwrap();
    let settings = RelaxSettings::default();
    let relaxer = Relaxer::new(&mesh, &positions, &settings, &|| false).unwrap();
    let mut domain = Domain::default();
    domain.grow(&mesh, mesh.vertex_ids(), 0);
    let input = relaxer.frame.positions();
    let scaled = |factor: f64| input.iter().map(|point| point * factor).collect::<Vec<_>>();
    let offer = |least: &mut LeastViolated, positions: &[_]| {
        least.offer(positions, relaxer.limits.num_violated(&mesh, positions, &domain));
    };
    let mut one_moved = input.to_vec();
    one_moved[5].x += 1.0;
    let mut least = LeastViolated { limit: 20, kept: None };
    offer(&mut least, &scaled(0.1));
    assert!(least.kept.is_none());
    offer(&mut least, &one_moved);
    assert!(least.kept.is_some());
    offer(&mut least, &scaled(1.1));
    offer(&mut least, &scaled(0.9));
    offer(&mut least, &one_moved);
    assert_eq!(least.kept.unwrap(), scaled(0.9));
}

#[test]
fn flatten_leaves_pieces_without_boundary_bit_for_bit() {
    let (mut description, mut positions) = roll();
    let open = positions.len();
    // An octahedron in the inner turn.
    let first = u32::try_from(open).unwrap();
    for (axis, sign) in [(0, 1.0), (1, 1.0), (0, -1.0), (1, -1.0), (2, 1.0), (2, -1.0)] {
        let mut place = [0.1, 0.0, 0.07];
        place[axis] += 0.04 * sign;
        positions.push(place);
    }
    for k in 0..4 {
        let (a, b) = (first + k, first + (k + 1) % 4);
        description.faces.extend([[a, b, first + 4], [b, a, first + 5]]);
    }
    description.num_vertices = positions.len();
    let mesh = Mesh::new(description).unwrap();
    assert_eq!(mesh.closed_pieces(), [false, true]);
    let settings = RelaxSettings { max_iterations: 30, ..RelaxSettings::default() };
    let mut relaxer = Relaxer::new(&mesh, &positions, &settings, &|| false).unwrap();
    let input = relaxer.frame.positions().to_vec();
    relaxer.set_frame(&input).unwrap();
    let mut best = BestState { merit: f64::INFINITY, positions: input.clone() };
    flatten(&mut relaxer, &mut best, &mut |_| ControlFlow::Continue(())).unwrap();
    assert_eq!(relaxer.frame.positions()[open..], input[open..]);
    assert_ne!(relaxer.frame.positions()[..open], input[..open]);
}

#[test]
fn flatten_on_one_or_three_threads_gives_same_bits() {
    let (description, positions) = roll();
    let mesh = Mesh::new(description).unwrap();
    let settings = RelaxSettings::default();
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut relaxer = Relaxer::new(&mesh, &positions, &settings, &|| false).unwrap();
            let input = relaxer.frame.positions().to_vec();
            relaxer.set_frame(&input).unwrap();
            let mut best = BestState { merit: f64::INFINITY, positions: input };
            flatten(&mut relaxer, &mut best, &mut |_| ControlFlow::Continue(())).unwrap();
            best.positions
        })
    };
    assert_eq!(on(1), on(3));
}
