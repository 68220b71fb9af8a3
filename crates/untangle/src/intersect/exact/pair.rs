//! Any pair of faces.

use super::{disjoint::contact_of_disjoint, one_vertex::contact_beyond_vertex};
use crate::{
    frame::Frame,
    intersect::filter::are_separated,
    mesh::{FaceId, Mesh, VertexId},
};

/// Whether two faces intersect: along a segment, beyond what they have in common. Ignored faces intersect nothing.
///
/// For callers that have pairs of faces already; [`Intersector`](crate::intersect::Intersector) finds all pairs of a
/// frame faster.
#[must_use]
pub fn do_intersect(mesh: &Mesh, frame: &Frame, faces: [FaceId; 2]) -> bool {
    if faces[0] == faces[1] || faces.iter().any(|&face| mesh.face_edges(face).is_none()) {
        return false;
    }
    if let Some(vertex) = common_vertex(mesh, faces) {
        return contact_beyond_vertex(mesh, frame, faces, vertex).is_some();
    }
    let [a, b] = faces.map(|face| mesh.face(face).map(|corner| frame.position(corner).into()));
    !are_separated(&a, &b) && contact_of_disjoint(mesh, frame, faces).is_some()
}

/// The first vertex that two faces have in common.
fn common_vertex(mesh: &Mesh, [a, b]: [FaceId; 2]) -> Option<VertexId> {
    let others = mesh.face(b);
    mesh.face(a).into_iter().find(|vertex| others.contains(vertex))
}
