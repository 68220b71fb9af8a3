//! Corrections of whole scenes: two sheets that pass through each other.

use std::sync::Arc;

use nalgebra::Vector3;

use super::{Corrections, Responder, VertexFlags};
use crate::{
    analysis::{Analysis, analyse},
    frame::Frame,
    mesh::{Mesh, MeshDescription, VertexId},
    paths::PairType,
    proximity::ProximitySearch,
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

/// A wavy sheet of 1 m, and a smaller one `height_m` over it, turned a bit, of edges of a tenth or less.
fn layers(cells: u32, height_m: f64) -> (MeshDescription, Vec<[f64; 3]>) {
    let mut description = MeshDescription::default();
    let mut positions = Vec::new();
    let wave = |x: f64, y: f64| 0.05 * (4.0 * x + 1.5 * y).sin();
    add_sheet(&mut description, &mut positions, [cells, cells], |x, y| [x, y, wave(x, y)]);
    add_sheet(&mut description, &mut positions, [cells, cells], |x, y| {
        let [x, y] = [0.2 + 0.5 * x - 0.1 * y, 0.2 + 0.5 * y + 0.1 * x];
        [x, y, wave(x, y) + height_m]
    });
    (description, positions)
}

/// The distance of the two layers, if it is below a tenth.
fn nearest_m(mesh: &Mesh, frame: &Frame) -> f64 {
    let mut found = Vec::new();
    ProximitySearch::default().find(mesh, frame, 0.1, usize::MAX, &mut found);
    let is_above = |vertex: VertexId| vertex.index() >= mesh.num_vertices() / 2;
    let layers = found.iter().filter(|pair| {
        let mut vertices = pair.primitives.vertices(mesh).map(is_above);
        let first = vertices.next();
        vertices.any(|is_above| Some(is_above) != first)
    });
    layers.map(|pair| pair.distance_m).fold(0.1, f64::min)
}

#[test]
fn layers_nearer_than_the_thickness_get_opposite_forces_and_others_none() {
    for (cells, response) in [(10, Response::Rbf), (20, Response::Rbf), (10, Response::Contour)] {
        let (description, positions) = layers(cells, 0.02);
        let num_below = (cells as usize + 1).pow(2);
        let mesh = Arc::new(Mesh::new(description).unwrap());
        let frame = Frame::new(&mesh, &positions).unwrap();
        let corrections = |thickness_m| {
            let settings = Settings { response, thickness_m, ..Settings::default() };
            Untangler::new(Arc::clone(&mesh), settings).unwrap().process(&frame, &mut ()).corrections.clone()
        };
        for thickness_m in [None, Some(0.0), Some(0.01)] {
            assert!(corrections(thickness_m).touched.is_empty(), "{thickness_m:?}");
        }
        let kept = corrections(Some(0.03));
        assert!(kept.net_force.norm() < 1e-12 && kept.net_torque.norm() < 1e-12);
        assert!(kept.flags.iter().all(|flags| *flags == VertexFlags::default()));
        let (below, above) = kept.forces.split_at(num_below);
        assert!(below.iter().all(|force| force.z <= 0.0), "{below:?}");
        assert!(above.iter().all(|force| force.z > 0.0), "{above:?}");
        // From rest the sheets get apart by what the law says, shared by both, and hardly anywhere by more.
        let largest = above.iter().map(|force| force.norm()).fold(0.0, f64::max);
        let law = 0.5 * (1.5 * 0.03 - nearest_m(&mesh, &frame));
        assert!(largest > 0.25 * law && largest < law, "{largest} {law}");
    }
}

#[test]
fn cloth_that_is_joined_along_the_surface_or_pinned_or_tangled_is_not_kept_apart() {
    let process = |description: MeshDescription, positions: &[[f64; 3]], thickness_m| {
        let mesh = Arc::new(Mesh::new(description).unwrap());
        let frame = Frame::new(&mesh, positions).unwrap();
        let settings = Settings { thickness_m: Some(thickness_m), ..Settings::default() };
        Untangler::new(mesh, settings).unwrap().process(&frame, &mut ()).corrections.clone()
    };
    let (mut description, mut positions) = (MeshDescription::default(), Vec::new());
    add_sheet(&mut description, &mut positions, [12, 12], |x, y| [x, y, 0.02 * (5.0 * x).sin()]);
    assert!(process(description, &positions, 0.2).touched.is_empty(), "over two edges, of one smooth sheet");
    let (description, positions) = layers(10, 0.02);
    let all = (0..u32::try_from(positions.len()).unwrap()).collect();
    let pinned = process(MeshDescription { pins: all, ..description.clone() }, &positions, 0.03);
    assert!(pinned.touched.is_empty());
    // Of a strip through a sheet nothing but what its paths ask for: all that is near is tangled.
    let (description, positions) = scene(0.25, false);
    let [thick, none] = [0.05, 1e-9].map(|thickness_m| process(description.clone(), &positions, thickness_m));
    let is_tangled = |vertex: &VertexId| thick.is_untangled(*vertex);
    assert!(none.touched.len() > 20);
    let kept: Vec<_> = thick.touched.iter().filter(|vertex| !none.touched.contains(vertex)).collect();
    assert!(kept.iter().all(|&vertex| is_tangled(vertex)), "{kept:?}");
}

#[test]
fn displacements_open_the_gap_of_layers_in_some_frames_and_intersect_nothing() {
    for (response, is_single) in
        [(Response::Displacement, true), (Response::Coupled, true), (Response::Displacement, false)]
    {
        let (description, mut positions) = layers(10, 0.004);
        let mesh = Arc::new(Mesh::new(description).unwrap());
        let settings = Settings { response, thickness_m: Some(0.03), ..Settings::default() };
        let mut untangler = Untangler::new(Arc::clone(&mesh), settings).unwrap();
        untangler.set_single_precision(is_single);
        let mut frame = Frame::new(&mesh, &positions).unwrap();
        assert!(nearest_m(&mesh, &frame) < 0.005);
        let mut num_frames = 0;
        while nearest_m(&mesh, &frame) < 0.03 {
            let outcome = untangler.process(&frame, &mut ());
            assert!(
                outcome.analysis.intersections.edge_face.is_empty() && num_frames < 60,
                "{:?} {}",
                ProximitySearch::default().nearest(&mesh, &frame),
                outcome.corrections.max_displacement_m
            );
            for (position, step) in positions.iter_mut().zip(&outcome.corrections.forces) {
                for axis in 0..3 {
                    position[axis] += step[axis];
                    #[expect(clippy::cast_possible_truncation, reason = "as such a host adds")]
                    let single = f64::from(position[axis] as f32);
                    position[axis] = if is_single { single } else { position[axis] };
                }
            }
            frame.set(&mesh, positions.iter().copied()).unwrap();
            num_frames += 1;
        }
        let last = untangler.process(&frame, &mut ());
        assert!(last.corrections.max_displacement_m < 0.05 * 0.03, "it ends: {}", last.corrections.max_displacement_m);
    }
}

#[test]
fn forces_that_keep_layers_apart_do_not_depend_on_the_order_of_faces_or_of_their_corners() {
    let (description, positions) = layers(10, 0.02);
    let forces = |faces: Vec<[u32; 3]>| {
        let mesh = Arc::new(Mesh::new(MeshDescription { faces, ..description.clone() }).unwrap());
        let frame = Frame::new(&mesh, &positions).unwrap();
        let settings = Settings { thickness_m: Some(0.03), ..Settings::default() };
        Untangler::new(mesh, settings).unwrap().process(&frame, &mut ()).corrections.forces.clone()
    };
    let faces = &description.faces;
    let expected = forces(faces.clone());
    assert!(expected.iter().any(|force| force.z > 0.0));
    assert_eq!(forces(faces.iter().rev().map(|&[a, b, c]| [b, c, a]).collect()), expected);
}
