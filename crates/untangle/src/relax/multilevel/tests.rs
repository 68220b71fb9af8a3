use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Point3, Rotation3, Vector3};

use super::*;
use crate::{
    mesh::{Mesh, MeshDescription, VertexId},
    relax::escape::tests::samples::Pieces,
};

fn points(positions: &[[f64; 3]]) -> Vec<Point3<f64>> {
    positions.iter().map(|&at| at.into()).collect()
}

/// Vertices less edges plus faces, pieces and boundary loops of a mesh.
fn topology(mesh: &Mesh) -> (i64, usize, usize) {
    let count = |number: usize| i64::try_from(number).unwrap();
    let euler = count(mesh.num_vertices()) - count(mesh.edge_ids().count()) + count(mesh.face_ids().count());
    let pieces: BTreeSet<_> = mesh.face_ids().map(|face| mesh.piece(face)).collect();
    let mut next = BTreeMap::new();
    for face in mesh.face_ids() {
        let [a, b, c] = mesh.face(face);
        for (from, to) in [(a, b), (b, c), (c, a)] {
            let is_boundary = |edge| mesh.edge_faces(edge).len() == 1 && mesh.edge(edge).contains(&to);
            if mesh.vertex_edges(from).iter().any(|&edge| is_boundary(edge)) {
                next.insert(from, to);
            }
        }
    }
    let mut num_loops = 0;
    while let Some((&first, _)) = next.iter().next() {
        num_loops += 1;
        let mut at = first;
        while let Some(to) = next.remove(&at) {
            at = to;
        }
    }
    (euler, pieces.len(), num_loops)
}

/// The least quality of a face, 1 for an equilateral one.
fn least_quality(mesh: &Mesh, at: &[Point3<f64>]) -> f64 {
    let qualities = mesh.face_ids().map(|face| {
        let [a, b, c] = mesh.face(face).map(|corner| at[corner.index()]);
        let sides = (b - a).norm_squared() + (c - b).norm_squared() + (a - c).norm_squared();
        12f64.sqrt() * (b - a).cross(&(c - a)).norm() / sides
    });
    qualities.fold(1.0, f64::min)
}

#[test]
fn coarser_mesh_is_the_same_surface_with_half_of_the_vertices() {
    for pieces in [Pieces::finger(24), Pieces::tubes(24), Pieces::tongue(40, 0.3)] {
        let (mesh, frame) = pieces.mesh();
        let coarser = CoarserMesh::of(&mesh, frame.positions()).unwrap();
        assert_eq!(topology(&coarser.mesh), topology(&mesh));
        let num_vertices = coarser.mesh.num_vertices();
        let [before, after] = [(&mesh, frame.positions()), (&coarser.mesh, &points(&coarser.positions))]
            .map(|(mesh, at)| least_quality(mesh, at));
        println!("{num_vertices} of {}, quality {before} and {after}", mesh.num_vertices());
        assert_eq!(num_vertices, mesh.num_vertices() / 2);
        assert!(coarser.mesh.edge_ids().all(|edge| coarser.mesh.edge_faces(edge).len() <= 2));
        // Good faces stay so, and others get no worse.
        assert!(after >= before.min(0.4));
    }
}

#[test]
fn state_carried_over_turns_with_the_coarser_mesh_and_leaves_what_stays_to_the_bit() {
    let (mesh, frame) = Pieces::finger(24).mesh();
    let input = frame.positions();
    let coarser = CoarserMesh::of(&mesh, input).unwrap();
    let mut state = points(&coarser.positions);
    assert_eq!(coarser.prolonged(input, &state), input);

    let turn = Rotation3::from_axis_angle(&Vector3::y_axis(), 1.1);
    let turned: Vec<Point3<f64>> = state.iter().map(|at| turn * at).collect();
    let found = coarser.prolonged(input, &turned);
    let farthest = found.iter().zip(input).map(|(found, at)| (found - turn * at).norm()).fold(0.0, f64::max);
    assert!(farthest < 1e-13, "{farthest:e}");

    let centre = state[0];
    state[0] += Vector3::z();
    let found = coarser.prolonged(input, &state);
    let moved = found.iter().zip(input).filter(|(found, at)| found != at).map(|(_, at)| (at - centre).norm());
    let (num_moved, farthest_m) = moved.fold((0, 0.0), |(count, most): (usize, f64), m| (count + 1, most.max(m)));
    println!("{num_moved} moved, up to {farthest_m} m away");
    assert!(num_moved > 1 && farthest_m < 0.4);
}

#[test]
fn pinned_vertices_and_those_of_edges_with_three_faces_stay() {
    let (mesh, frame) = Pieces::finger(24).mesh();
    let faces: Vec<[u32; 3]> = mesh.face_ids().map(|face| mesh.face(face).map(|corner| corner.0)).collect();
    let pins: Vec<u32> = (100..140).collect();
    // A third face at each edge of the twelfth.
    let [a, b, c] = faces[12];
    let tip = u32::try_from(mesh.num_vertices()).unwrap();
    let faces = [&faces[..], &[[a, b, tip], [b, c, tip], [c, a, tip]]].concat();
    let description =
        MeshDescription { num_vertices: mesh.num_vertices() + 1, faces, pins: pins.clone(), ..Default::default() };
    let mesh = Mesh::new(description).unwrap();
    let centre =
        [a, b, c].iter().fold(Vector3::zeros(), |sum, &corner| sum + frame.positions()[corner as usize].coords);
    let positions = [frame.positions(), &[Point3::from(centre / 3.0 + Vector3::z() * 0.1)]].concat();
    let coarser = CoarserMesh::of(&mesh, &positions).unwrap();
    let is_there = |vertex: u32| coarser.positions.contains(&positions[vertex as usize].into());
    assert!(pins.iter().chain(&[a, b, c]).all(|&vertex| is_there(vertex)));
    let num_pinned = coarser.mesh.vertex_ids().filter(|&vertex: &VertexId| coarser.mesh.is_pinned(vertex)).count();
    assert_eq!(num_pinned, pins.len());
}

#[test]
fn coarse_meshes_and_those_that_are_pinned_have_no_coarser_one() {
    let (mesh, frame) = Pieces::finger(8).mesh();
    assert!(CoarserMesh::of(&mesh, frame.positions()).is_none());
    let (mesh, frame) = Pieces::finger(24).mesh();
    let description = MeshDescription {
        num_vertices: mesh.num_vertices(),
        faces: mesh.face_ids().map(|face| mesh.face(face).map(|corner| corner.0)).collect(),
        pins: mesh.vertex_ids().map(|vertex| vertex.0).collect(),
        ..Default::default()
    };
    assert!(CoarserMesh::of(&Mesh::new(description).unwrap(), frame.positions()).is_none());
}
