//! Straightening by itself, on a strip that is rolled up.

use super::*;
use crate::{
    correspond::samples::sheet_faces,
    mesh::{Mesh, MeshDescription},
    relax::RelaxSettings,
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

/// Straightens within so many iterations, and interrupts where nothing intersects for the first time if asked. Gives back how it
/// ended, whether the best state is clean, and what was left after each iteration.
fn straightened(most: usize, interrupt: bool) -> (End, bool, Vec<usize>) {
    let (description, positions) = roll();
    let mesh = Mesh::new(description).unwrap();
    let settings = RelaxSettings { max_iterations: most, ..RelaxSettings::default() };
    let mut relaxer = Relaxer::new(&mesh, &positions, &settings).unwrap();
    let input = relaxer.frame.positions().to_vec();
    relaxer.set_frame(&input).unwrap();
    assert!(relaxer.analyser.last().intersections.edge_face.len() > 20);
    let mut best = Best { merit: f64::INFINITY, positions: input };
    let mut left = Vec::new();
    let mut progress = |step: &Iteration| {
        left.push(step.num_edge_face_intersections);
        if interrupt && step.num_edge_face_intersections == 0 {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    };
    let end = relaxer.straighten(&mut best, &mut progress).unwrap();
    relaxer.set_frame(&best.positions).unwrap();
    (end, relaxer.analyser.last().intersections.edge_face.is_empty(), left)
}

#[test]
fn a_clean_state_is_given_back_wherever_the_way_back_ends() {
    let (end, clean, left) = straightened(100, false);
    assert!(end == End::Clean && clean, "{end:?} {left:?}");
    let first = left.iter().position(|&left| left == 0).unwrap() + 1;
    assert!(first + 2 < left.len());
    for most in first..left.len() {
        let (end, clean, left) = straightened(most, false);
        assert!(end == End::Clean && clean, "{most} {end:?} {left:?}");
    }
    let (end, clean, _) = straightened(0, false);
    assert!(end == End::Exhausted && !clean, "{end:?}");
    // Where it is interrupted before the way back, what is flat is all there is.
    let (end, clean, left) = straightened(100, true);
    assert!(end == End::Interrupted && clean, "{end:?} {left:?}");
}

#[test]
fn of_clean_states_the_one_that_crushes_least_is_kept_and_of_equals_the_last() {
    let (description, positions) = roll();
    let mesh = Mesh::new(description).unwrap();
    let settings = RelaxSettings::default();
    let relaxer = Relaxer::new(&mesh, &positions, &settings).unwrap();
    let mut domain = Domain::default();
    domain.grow(&mesh, mesh.vertex_ids(), 0);
    let input = relaxer.frame.positions();
    let scaled = |factor: f64| input.iter().map(|point| point * factor).collect::<Vec<_>>();
    let mut one_moved = input.to_vec();
    one_moved[5].x += 1.0;
    let mut least = Least { limit: 20, kept: None };
    relaxer.offer(&domain, &scaled(0.1), &mut least);
    assert!(least.kept.is_none());
    relaxer.offer(&domain, &one_moved, &mut least);
    assert!(least.kept.is_some());
    relaxer.offer(&domain, &scaled(1.1), &mut least);
    relaxer.offer(&domain, &scaled(0.9), &mut least);
    relaxer.offer(&domain, &one_moved, &mut least);
    assert_eq!(least.kept.unwrap(), scaled(0.9));
}

#[test]
fn pieces_without_a_boundary_stay_as_they_are() {
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
    let mut relaxer = Relaxer::new(&mesh, &positions, &settings).unwrap();
    let input = relaxer.frame.positions().to_vec();
    relaxer.set_frame(&input).unwrap();
    let mut best = Best { merit: f64::INFINITY, positions: input.clone() };
    relaxer.straighten(&mut best, &mut |_| ControlFlow::Continue(())).unwrap();
    assert_eq!(relaxer.frame.positions()[open..], input[open..]);
    assert_ne!(relaxer.frame.positions()[..open], input[..open]);
}

#[test]
fn any_number_of_threads_straightens_to_the_same_bits() {
    let (description, positions) = roll();
    let mesh = Mesh::new(description).unwrap();
    let settings = RelaxSettings::default();
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut relaxer = Relaxer::new(&mesh, &positions, &settings).unwrap();
            let input = relaxer.frame.positions().to_vec();
            relaxer.set_frame(&input).unwrap();
            let mut best = Best { merit: f64::INFINITY, positions: input };
            relaxer.straighten(&mut best, &mut |_| ControlFlow::Continue(())).unwrap();
            best.positions
        })
    };
    assert_eq!(on(1), on(3));
}
