//! The relaxation of small meshes of every degeneracy, with the exact judge behind it.

use std::ops::ControlFlow;

use untangle::{
    frame::Frame,
    intersect::{Intersections, Intersector},
    mesh::{Mesh, MeshDescription},
    relax::{Effort, RelaxSettings, Relaxation, relax},
};
use untangled_checker::{PolygonRef, polygon_crossings};

use super::clouds::Cloud;

/// Enough for meshes of few faces; a mesh that nothing helps ends before.
const MAX_ITERATIONS: usize = 12;

/// A cloud; of its choices the first bits say precision, effort, whether the first vertices are pinned, and whether
/// what hangs together with the first face is a body.
pub(super) fn relax_cloud(bytes: &[u8]) -> bool {
    let mut cloud = Cloud::of(bytes);
    let single_precision = cloud.choices & 1 != 0;
    if single_precision {
        // A file that holds no more has given no more: what is pinned stays, and is rounded already.
        cloud.positions.as_flattened_mut().iter_mut().for_each(|x| *x = f64::from(*x as f32));
    }
    let Ok(mesh) = Mesh::new(description(&cloud)) else { return false };
    let Ok(before) = Frame::new(&mesh, &cloud.positions) else { return false };
    let settings = RelaxSettings {
        effort: [Effort::Fast, Effort::Balanced][usize::from(cloud.choices >> 1 & 1)],
        max_iterations: MAX_ITERATIONS,
        single_precision,
        other_attempts: true,
    };
    let run = || relax(&mesh, &cloud.positions, &settings, &mut |_| ControlFlow::Continue(())).expect("it is a frame");
    let relaxation = run();
    assert!(relaxation == run(), "the same input, the same answer");
    check(&mesh, &cloud, &before, &relaxation);
    true
}

fn description(cloud: &Cloud) -> MeshDescription {
    let mut description = cloud.description();
    if cloud.choices & 4 != 0 {
        description.pins = vec![0, 1, 2];
    }
    if cloud.choices & 8 != 0 {
        description.body = joined(&cloud.faces);
    }
    description
}

/// The vertices that hang together with the first face, ascending.
fn joined(faces: &[[u32; 3]]) -> Vec<u32> {
    let mut joined = faces[0].to_vec();
    while let Some(face) =
        faces.iter().find(|face| face.iter().any(|v| joined.contains(v)) && !face.iter().all(|v| joined.contains(v)))
    {
        joined.extend(face);
    }
    joined.sort_unstable();
    joined.dedup();
    joined
}

fn check(mesh: &Mesh, cloud: &Cloud, before: &Frame, relaxation: &Relaxation) {
    let Relaxation { positions, history, blocked, interrupted } = relaxation;
    assert!(!interrupted, "nobody asked for it");
    assert_eq!(positions.len(), mesh.num_vertices());
    let after = Frame::new(mesh, positions).expect("what is left is a frame");
    let is_moved = |vertex: usize| positions[vertex].map(f64::to_bits) != cloud.positions[vertex].map(f64::to_bits);
    for vertex in mesh.vertex_ids().filter(|&vertex| mesh.is_pinned(vertex)) {
        assert!(!is_moved(vertex.index()), "pinned vertex {} moved", vertex.0);
    }
    if history.is_empty() {
        assert!((0..positions.len()).all(|vertex| !is_moved(vertex)), "no iteration moved anything");
    }
    let [num_before, num_after] = [before, &after].map(|frame| num_intersections(mesh, frame));
    assert_eq!(blocked.is_empty(), num_after == 0, "{num_after} intersections are left, and {} paths", blocked.len());
    if num_before == 0 && !mesh.has_body() {
        assert!((0..positions.len()).all(|vertex| !is_moved(vertex)), "what is clean stays as it is");
    }
    if num_after == 0 {
        assert_eq!(judged(mesh, positions), 0, "it is said to be clean, but the judge finds crossings");
    }
    assert!(blocked.iter().all(|path| !path.reason.is_empty() && path.length_m.is_finite()), "a reason for each path");
    assert!(blocked.iter().all(|path| (path.vertex as usize) < mesh.num_vertices()));
}

fn num_intersections(mesh: &Mesh, frame: &Frame) -> usize {
    let mut found = Intersections::default();
    Intersector::default().intersect(mesh, frame, &mut found);
    found.edge_face.len()
}

/// Pairs of faces that cross, without those of two faces of bodies.
fn judged(mesh: &Mesh, positions: &[[f64; 3]]) -> usize {
    let triangles: Vec<[u32; 3]> = mesh.face_ids().map(|face| mesh.face(face).map(|vertex| vertex.0)).collect();
    let are_bodies = mesh.face_ids().map(|face| mesh.is_body_face(face));
    let polygons = triangles.iter().zip(are_bodies).map(|(corners, is_body)| PolygonRef {
        corners,
        triangles: std::slice::from_ref(corners),
        is_body,
    });
    polygon_crossings(positions, polygons, false).expect("it can be judged").pairs.len()
}
