//! What keeps layers apart that are in no tangle.

use std::sync::Arc;

use super::{VertexFlags, add_sheet, scene};
use crate::{
    frame::Frame,
    mesh::{Mesh, MeshDescription, VertexId},
    proximity::ProximitySearch,
    settings::{Response, Settings},
    untangler::Untangler,
};

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
fn forces_that_keep_layers_apart_are_as_large_on_finer_meshes() {
    // What they displace the upper sheet by in one step, on the average; each vertex has one kilogram.
    let mean_m = |cells: u32| {
        let (description, positions) = layers(cells, 0.008);
        let mesh = Arc::new(Mesh::new(description).unwrap());
        let frame = Frame::new(&mesh, &positions).unwrap();
        let settings = Settings { thickness_m: Some(0.012), ..Settings::default() };
        let mut untangler = Untangler::new(Arc::clone(&mesh), settings).unwrap();
        let above = &untangler.process(&frame, &mut ()).corrections.forces[mesh.num_vertices() / 2..];
        above.iter().map(|force| force.z).sum::<f64>() / f64::from((cells + 1).pow(2))
    };
    let coarse_m = mean_m(10);
    for cells in [20, 40] {
        let fine_m = mean_m(cells);
        println!("edges of 1/{cells}: {fine_m}, of a tenth: {coarse_m}");
        assert!(fine_m > 0.7 * coarse_m);
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
