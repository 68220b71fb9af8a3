//! Limits of the shape of edges and faces, beyond which no vertex may take them.

use nalgebra::Point3;

use crate::{
    mesh::{EdgeId, FaceId, Mesh, VertexId},
    relax::energy::RestShape,
};

/// How far edges and faces may get from their shape in the input.
#[derive(Clone, Copy, Debug)]
pub(in crate::relax) struct ShapeLimits {
    /// No edge may get longer than this many times its length in the input, or shorter than the inverse.
    pub(in crate::relax) max_stretch: f64,
    /// No face may keep less than this part of its area.
    pub(in crate::relax) min_area: f64,
}

impl ShapeLimits {
    /// Those of descent and shape recovery: narrower than those of trials.
    pub(in crate::relax) const DESCENT: Self = Self { max_stretch: 1.5, min_area: 0.25 };

    /// Whether a face or an edge of a vertex is beyond its limit after a step, and farther than before it.
    pub(in crate::relax) fn are_violated(
        self,
        mesh: &Mesh,
        rest: &RestShape,
        before: &[Point3<f64>],
        after: &[Point3<f64>],
        vertex: VertexId,
    ) -> bool {
        let Self { max_stretch, min_area } = self;
        let is_edge_violated = |&edge: &EdgeId| {
            let ends = mesh.edge(edge);
            let length = |at: &dyn Fn(VertexId) -> Point3<f64>| (at(ends[1]) - at(ends[0])).norm();
            let input = length(&|vertex| rest.position(vertex));
            let now = length(&|vertex| after[vertex.index()]);
            if input == 0.0 || (now <= max_stretch * input && now * max_stretch >= input) {
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
            now < min_area * area(&|vertex| rest.position(vertex)) && now < area(&|vertex| before[vertex.index()])
        };
        mesh.vertex_edges(vertex).iter().any(is_edge_violated) || mesh.vertex_faces(vertex).iter().any(is_face_violated)
    }
}
