//! Corrections of whole scenes: two sheets that pass through each other.

mod gap;

use std::sync::Arc;

use nalgebra::Vector3;

use super::{Corrections, Responder, VertexFlags};
use crate::{
    analysis::{Analysis, analyse},
    frame::Frame,
    mesh::{Mesh, MeshDescription, VertexId},
    paths::PairType,
    settings::{Response, Settings},
    untangler::Untangler,
};

/// Adds a sheet of `columns x rows` squares to a mesh.
fn add_sheet(
    description: &mut MeshDescription,
    positions: &mut Vec<[f64; 3]>,
    [columns, rows]: [u32; 2],
    at: impl Fn(f64, f64) -> [f64; 3],
) {
    let first = u32::try_from(positions.len()).unwrap();
    for row in 0..=rows {
        for column in 0..=columns {
            positions.push(at(f64::from(column) / f64::from(columns), f64::from(row) / f64::from(rows)));
            if row < rows && column < columns {
                let a = first + row * (columns + 1) + column;
                let c = a + columns + 1;
                description.faces.extend([[a, a + 1, c], [c, a + 1, c + 1]]);
            }
        }
    }
    description.num_vertices = positions.len();
}

/// A sheet of 1 m and a strip that dips through it by `depth_m`, from the middle, or, `from_side`, with one edge only.
fn scene(depth_m: f64, from_side: bool) -> (MeshDescription, Vec<[f64; 3]>) {
    let mut description = MeshDescription::default();
    let mut positions = Vec::new();
    add_sheet(&mut description, &mut positions, [10, 10], |x, y| [x - 0.5, y - 0.5, 0.01 * (9.0 * x + 4.0 * y).sin()]);
    let shift = if from_side { 0.37 } else { 0.0 };
    add_sheet(&mut description, &mut positions, [4, 6], |x, y| {
        [0.4 * x - 0.21 + shift, 0.013 + 0.1 * x * x + 0.05 * y, 0.6 * y - depth_m]
    });
    (description, positions)
}

struct Answer {
    mesh: Mesh,
    frame: Frame,
    analysis: Analysis,
    corrections: Corrections,
}

fn respond(description: MeshDescription, positions: &[[f64; 3]], response: Response) -> Answer {
    let mesh = Mesh::new(description).unwrap();
    let frame = Frame::new(&mesh, positions).unwrap();
    let analysis = analyse(&mesh, &frame);
    let settings = Settings { response, ..Settings::default() };
    let mut responder = Responder::default();
    let corrections = responder.respond(&mesh, &frame, &analysis, &settings, &mut ()).clone();
    // The second frame must not depend on the first.
    let again = responder.respond(&mesh, &frame, &analysis, &settings, &mut ());
    assert_eq!((&corrections.forces, &corrections.flags), (&again.forces, &again.flags));
    Answer { mesh, frame, analysis, corrections }
}

#[test]
fn responder_keeps_both_momenta() {
    for (from_side, expected) in [(false, PairType::BoundaryBoundaryInsideInside), (true, PairType::BoundaryInside)] {
        for response in [Response::Rbf, Response::Contour] {
            let (description, positions) = scene(0.17, from_side);
            let answer = respond(description, &positions, response);
            assert_eq!(answer.analysis.paths.pairs[0].pair_type, expected);
            let (mut forces, mut torques) = (0.0, 0.0);
            for (position, force) in answer.frame.positions().iter().zip(&answer.corrections.forces) {
                forces += force.norm();
                torques += position.coords.norm() * force.norm();
            }
            assert!(forces > 0.01, "{forces}");
            assert!(answer.corrections.net_force.norm() < 1e-12 * forces);
            assert!(answer.corrections.net_torque.norm() < 1e-12 * torques);
        }
    }
}

#[test]
fn responder_on_clean_scene_gives_zeros_bit_for_bit() {
    let (description, positions) = scene(-0.05, false);
    for response in [Response::Rbf, Response::Contour, Response::Displacement, Response::Mask] {
        let corrections = respond(description.clone(), &positions, response).corrections;
        assert!(corrections.forces.iter().all(|force| force.iter().all(|value| value.to_bits() == 0)));
        assert!(corrections.flags.iter().all(|&flags| flags == VertexFlags::default()));
        assert_eq!(corrections.max_displacement_m.to_bits(), 0);
    }
}

#[test]
fn mask_response_flags_without_forces() {
    let (mut description, positions) = scene(0.17, false);
    description.pins = vec![0];
    let Answer { mesh, analysis, corrections, .. } = respond(description, &positions, Response::Mask);
    assert!(corrections.forces.iter().all(|force| *force == Vector3::zeros()));
    let inside: Vec<_> =
        mesh.vertex_ids().filter(|v| corrections.flags[v.index()].contains(VertexFlags::INSIDE)).collect();
    assert_eq!(inside, analysis.regions.vertices);
    assert_eq!(inside.len(), 10);
    assert_eq!(corrections.flags[0], VertexFlags::PINNED);
    let near = corrections.flags.iter().filter(|flags| flags.contains(VertexFlags::NEAR_PATH)).count();
    assert!(near > inside.len() && near < 2 * mesh.num_vertices() / 3, "{near}");
}

#[test]
fn responder_spares_pinned_vertices_and_scales_with_mass() {
    let (mut description, positions) = scene(0.17, false);
    let free = respond(description.clone(), &positions, Response::Rbf);
    let pinned = free.analysis.regions.vertices[0];
    description.pins = vec![pinned.0];
    description.masses_kg = Some(vec![0.002; positions.len()]);
    let heavy = respond(description, &positions, Response::Rbf);
    assert_eq!(heavy.corrections.forces[pinned.index()], Vector3::zeros());
    assert_ne!(free.corrections.forces[pinned.index()], Vector3::zeros());
    for vertex in free.mesh.vertex_ids().filter(|&vertex| vertex != pinned) {
        let (light, scaled) = (free.corrections.forces[vertex.index()], heavy.corrections.forces[vertex.index()]);
        assert!((light * 0.002 - scaled).norm() < 1e-15);
    }
    let largest = 3.0 * Settings::default().max_step_edge_lengths * 0.2;
    assert!(heavy.corrections.max_displacement_m < largest, "{}", heavy.corrections.max_displacement_m);
}

#[test]
fn steps_along_corrections_resolve_the_scene() {
    for (response, from_side, most) in [
        (Response::Rbf, false, 12),
        (Response::Rbf, true, 25),
        (Response::Displacement, false, 4),
        (Response::Displacement, true, 25),
    ] {
        let (description, mut positions) = scene(0.17, from_side);
        let mut steps = 0;
        loop {
            let answer = respond(description.clone(), &positions, response);
            if answer.analysis.intersections.edge_face.is_empty() {
                break;
            }
            assert!(steps < most, "{response:?}, from the side {from_side}: not resolved after {most} steps");
            for (position, force) in positions.iter_mut().zip(&answer.corrections.forces) {
                *position = (Vector3::from(*position) + force).into();
            }
            steps += 1;
        }
        println!("{response:?}, from the side {from_side}: {steps} steps");
        assert!(steps > 0);
    }
}

#[test]
fn corrections_list_what_was_touched_and_keep_nothing_of_the_frame_before() {
    let (mut description, tangled) = scene(0.17, false);
    description.pins = vec![0, 1];
    // And one that is inside.
    description.pins.extend(
        respond(description.clone(), &tangled, Response::Mask).analysis.regions.vertices[0..1].iter().map(|v| v.0),
    );
    let mesh = Arc::new(Mesh::new(description).unwrap());
    let frames = [&tangled, &scene(0.17, true).1, &scene(-0.3, false).1, &tangled]
        .map(|positions| Frame::new(&mesh, positions).unwrap());
    let untangler = |response| Untangler::new(Arc::clone(&mesh), Settings { response, ..Settings::default() }).unwrap();
    for response in [Response::Rbf, Response::Contour, Response::Displacement, Response::Coupled, Response::Mask] {
        let mut one_for_all = untangler(response);
        for (k, frame) in frames.iter().enumerate() {
            let mut fresh = untangler(response);
            let expected = fresh.process(frame, &mut ()).corrections;
            let corrections = one_for_all.process(frame, &mut ()).corrections;
            assert_eq!(corrections.forces, expected.forces, "{response:?}, frame {k}");
            assert_eq!(corrections.flags, expected.flags, "{response:?}, frame {k}");
            let is_touched = |vertex: &VertexId| {
                let VertexFlags(flags) = corrections.flags[vertex.index()];
                corrections.forces[vertex.index()] != Vector3::zeros() || flags & !VertexFlags::PINNED.0 != 0
            };
            assert_eq!(corrections.touched, mesh.vertex_ids().filter(is_touched).collect::<Vec<_>>(), "{response:?}");
            assert!(
                mesh.vertex_ids()
                    .all(|v| corrections.flags[v.index()].contains(VertexFlags::PINNED) == mesh.is_pinned(v))
            );
            assert_eq!(corrections.touched.is_empty(), k == 2, "{response:?}, frame {k}");
        }
    }
}
