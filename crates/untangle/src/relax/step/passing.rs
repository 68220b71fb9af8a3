//! Where the sheets are to pass through each other: what meets there is no contact.

use crate::{
    analysis::Analysis,
    mesh::{Mesh, VertexId},
    sparse_map::SparseMap,
};

/// Marks where the sheets are to pass through each other: along the paths and inside of them.
pub(crate) fn mark_passing(mesh: &Mesh, analysis: &Analysis, passing: &mut SparseMap<VertexId, ()>) {
    passing.reset(mesh.num_vertices());
    for segment in &analysis.intersections.segments {
        for vertex in segment.faces.into_iter().flat_map(|face| mesh.face(face)) {
            passing.set(vertex, ());
        }
    }
    for &vertex in &analysis.regions.vertices {
        passing.set(vertex, ());
    }
}
