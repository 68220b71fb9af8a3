//! The direction in which a pair of primitives comes apart.

use nalgebra::Vector3;

use super::pair::{ClosestPoints, Primitives};
use crate::{
    frame::Frame,
    mesh::{Mesh, VertexId},
    predicates::{Side, side_of_plane},
};

/// Below this part of the size of its primitives a distance has no direction of its own: rounding made it.
const NO_DIRECTION: f64 = 1e-10;

/// The direction in which the first of two primitives gets away from the second: along the line of their closest
/// points, of those that touch along a normal. Nothing where there is none.
pub(crate) fn direction_apart(
    mesh: &Mesh,
    frame: &Frame,
    primitives: Primitives,
    closest: &ClosestPoints,
) -> Option<Vector3<f64>> {
    let distance_m = closest.offset.norm();
    if distance_m > NO_DIRECTION * size_m(mesh, frame, primitives) {
        Some(closest.offset / distance_m)
    } else {
        normal(mesh, frame, primitives, closest)
    }
}

fn size_m(mesh: &Mesh, frame: &Frame, primitives: Primitives) -> f64 {
    let mut vertices = primitives.vertices(mesh);
    let Some(first) = vertices.next() else { return 0.0 };
    vertices.map(|vertex| (frame.position(vertex) - frame.position(first)).norm()).fold(0.0, f64::max)
}

/// The direction in which touching primitives come apart: the normal of the face or of both edges, towards the side on
/// which exact signs say that the first one lies. Nothing where there is no normal.
fn normal(mesh: &Mesh, frame: &Frame, primitives: Primitives, closest: &ClosestPoints) -> Option<Vector3<f64>> {
    let (signed, [a, b, c]): ([VertexId; 4], [Vector3<f64>; 3]) = match primitives {
        Primitives::VertexFace { vertex, .. } => {
            let [a, b, c] = closest.vertices[1];
            let at = |vertex: VertexId| frame.position(vertex).coords;
            ([a, b, c, vertex], [at(a), at(b), at(c)])
        }
        Primitives::EdgeEdge { edges } => {
            let [[a, b], [c, d]] = edges.map(|edge| mesh.edge(edge));
            let at = |vertex: VertexId| frame.position(vertex).coords;
            ([a, b, c, d], [at(a), at(b), at(a) + at(d) - at(c)])
        }
    };
    let normal = (b - a).cross(&(c - a));
    let length = normal.norm();
    let [a, b, c, d] = signed.map(|vertex| frame.site(vertex));
    let sign = if side_of_plane(a, b, c, d) == Side::Above { 1.0 } else { -1.0 };
    (length > 0.0).then(|| normal * (sign / length))
}
