//! The check of a repaired state, by code that the library has no part in.

use untangle::mesh::Mesh;
use untangled_checker::{PolygonRef, polygon_crossings, vertices_behind_layers, vertices_inside};

/// What is wrong with a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Verdict {
    /// Pairs of faces that cross; those of two faces of bodies are not looked for.
    pub(super) num_crossings: usize,
    /// Vertices of cloth inside of a body.
    pub(super) num_inside: usize,
    /// Vertices behind a layer that lies further in.
    pub(super) num_behind: usize,
}

impl Verdict {
    /// Vertices on the wrong side of a body or of a layer.
    pub(super) fn num_wrong(self) -> usize {
        self.num_inside.saturating_add(self.num_behind)
    }
}

/// Judges a state. The mesh says what is outwards of its layers: see
/// [`Layers::decide`](untangle::sides::Layers::decide). A frame is finite, and a mesh has valid faces; what can't be
/// judged is not clean.
pub(super) fn judge(mesh: &Mesh, positions: &[[f64; 3]]) -> Verdict {
    let triangles: Vec<[u32; 3]> = mesh.face_ids().map(|face| mesh.face(face).map(|vertex| vertex.0)).collect();
    let are_bodies = mesh.face_ids().map(|face| mesh.is_body_face(face));
    let polygons = triangles.iter().zip(are_bodies).map(|(corners, is_body)| PolygonRef {
        corners,
        triangles: std::slice::from_ref(corners),
        is_body,
    });
    let num_crossings = polygon_crossings(positions, polygons, false).map_or(usize::MAX, |found| found.pairs.len());
    let num_inside = num_inside(mesh, positions, &triangles);
    Verdict { num_crossings, num_inside, num_behind: num_behind(mesh, positions, &triangles) }
}

/// Vertices of cloth inside of a body.
fn num_inside(mesh: &Mesh, positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> usize {
    if !mesh.has_body() {
        return 0;
    }
    let faces = mesh.face_ids().zip(triangles).filter(|(face, _)| mesh.is_body_face(*face));
    let body: Vec<[u32; 3]> = faces.map(|(_, corners)| *corners).collect();
    let is_cloth = |vertex: &_| !mesh.is_body(*vertex) && !mesh.vertex_faces(*vertex).is_empty();
    let cloth = mesh.vertex_ids().filter(is_cloth).map(|vertex| vertex.0);
    vertices_inside(positions, cloth, &body).map_or(usize::MAX, |inside| inside.len())
}

/// Vertices of cloth behind a layer that lies further in.
fn num_behind(mesh: &Mesh, positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> usize {
    let (Some(numbers), Some(outwards)) = (mesh.layers(), mesh.outwards()) else { return 0 };
    let faces = mesh.face_ids().zip(triangles).filter(|(face, _)| !mesh.is_body_face(*face));
    let (cloth, are_outwards): (Vec<[u32; 3]>, Vec<bool>) =
        faces.map(|(face, corners)| (*corners, outwards[face.index()])).unzip();
    vertices_behind_layers(positions, &cloth, numbers, &are_outwards).map_or(usize::MAX, |behind| behind.len())
}
