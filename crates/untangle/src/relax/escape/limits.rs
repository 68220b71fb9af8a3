//! Strain limits of the descent: narrower than those of trials, and always held.

use nalgebra::Point3;

use crate::{
    mesh::{EdgeId, FaceId, Mesh, VertexId},
    relax::energy::RestShape,
};

/// No edge may get longer than this many times its length in the input, or shorter than the inverse.
const MAX_STRETCH: f64 = 1.5;
/// No face may keep less than this part of its area.
const MIN_AREA: f64 = 0.25;

/// Whether a face or an edge of a vertex is beyond its limit after a step, and farther than before it.
pub(super) fn is_violated(
    mesh: &Mesh,
    rest: &RestShape,
    before: &[Point3<f64>],
    after: &[Point3<f64>],
    vertex: VertexId,
) -> bool {
    let is_edge_violated = |&edge: &EdgeId| {
        let ends = mesh.edge(edge);
        let length = |at: &dyn Fn(VertexId) -> Point3<f64>| (at(ends[1]) - at(ends[0])).norm();
        let input = length(&|vertex| rest.position(vertex));
        let now = length(&|vertex| after[vertex.index()]);
        if input == 0.0 || (now <= MAX_STRETCH * input && now * MAX_STRETCH >= input) {
            return false;
        }
        let then = length(&|vertex| before[vertex.index()]);
        if now > input { now > then } else { now < then }
    };
    let is_face_violated = |&face: &FaceId| {
        let corners = mesh.face(face);
        let area = |at: &dyn Fn(VertexId) -> Point3<f64>| {
            let [a, b, c] = corners.map(at);
            (b - a).cross(&(c - a)).norm()
        };
        let now = area(&|vertex| after[vertex.index()]);
        now < MIN_AREA * area(&|vertex| rest.position(vertex)) && now < area(&|vertex| before[vertex.index()])
    };
    mesh.vertex_edges(vertex).iter().any(is_edge_violated) || mesh.vertex_faces(vertex).iter().any(is_face_violated)
}
