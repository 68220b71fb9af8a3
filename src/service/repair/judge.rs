//! The check of a repaired state, by code that the library has no part in.

use untangle::mesh::Mesh;
use untangled_checker::{PolygonRef, polygon_crossings, vertices_inside};

/// What is wrong with a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Verdict {
    /// Pairs of faces that cross; those of two faces of bodies are not looked for.
    pub(super) num_crossings: usize,
    /// Vertices of cloth inside of a body.
    pub(super) num_inside: usize,
}

/// Judges a state. A frame is finite, and a mesh has valid faces; what can't be judged is not clean.
pub(super) fn judge(mesh: &Mesh, positions: &[[f64; 3]]) -> Verdict {
    let triangles: Vec<[u32; 3]> = mesh.face_ids().map(|face| mesh.face(face).map(|vertex| vertex.0)).collect();
    let are_bodies = mesh.face_ids().map(|face| mesh.is_body_face(face));
    let polygons = triangles.iter().zip(are_bodies.clone()).map(|(corners, is_body)| PolygonRef {
        corners,
        triangles: std::slice::from_ref(corners),
        is_body,
    });
    let num_crossings = polygon_crossings(positions, polygons, false).map_or(usize::MAX, |found| found.pairs.len());
    if !mesh.has_body() {
        return Verdict { num_crossings, num_inside: 0 };
    }
    let body: Vec<[u32; 3]> =
        triangles.iter().zip(are_bodies).filter(|(_, is_body)| *is_body).map(|(corners, _)| *corners).collect();
    let is_cloth = |vertex: &_| !mesh.is_body(*vertex) && !mesh.vertex_faces(*vertex).is_empty();
    let cloth = mesh.vertex_ids().filter(is_cloth).map(|vertex| vertex.0);
    let num_inside = vertices_inside(positions, cloth, &body).map_or(usize::MAX, |inside| inside.len());
    Verdict { num_crossings, num_inside }
}
