//! Separation constraints of pairs that are to be set apart, or to stay apart.

use nalgebra::Vector3;

use crate::{
    correspond::MaterialPoint,
    frame::Frame,
    mesh::{Mesh, VertexId},
    predicates::{Side, side_of_plane},
    proximity::{Primitives, closest_points},
    relax::constraints::Constraints,
};

/// Below this part of the size of its primitives a distance has no direction of its own: rounding made it.
const NO_DIRECTION: f64 = 1e-10;

/// Adds the constraint that the closest points of a pair are to be `wanted_m` apart.
pub(super) fn add_row(
    constraints: &mut Constraints,
    mesh: &Mesh,
    frame: &Frame,
    primitives: Primitives,
    wanted_m: f64,
) {
    let closest = closest_points(mesh, frame, primitives);
    let [own, partner] =
        [0, 1].map(|side| MaterialPoint { vertices: closest.vertices[side], weights: closest.weights[side] });
    let distance_m = closest.offset.norm();
    let size = size_m(mesh, frame, primitives);
    let direction = if distance_m > NO_DIRECTION * size {
        Some(closest.offset / distance_m)
    } else {
        normal(mesh, frame, primitives)
    };
    if let Some(direction) = direction {
        constraints.separate(&own, &partner, direction, wanted_m - distance_m);
    }
}

fn size_m(mesh: &Mesh, frame: &Frame, primitives: Primitives) -> f64 {
    let mut vertices = primitives.vertices(mesh);
    let Some(first) = vertices.next() else { return 0.0 };
    vertices.map(|vertex| (frame.position(vertex) - frame.position(first)).norm()).fold(0.0, f64::max)
}

/// The direction in which touching primitives come apart: the normal of the face or of both edges, towards the side on
/// which exact signs say that the first one lies. Nothing where there is no normal.
fn normal(mesh: &Mesh, frame: &Frame, primitives: Primitives) -> Option<Vector3<f64>> {
    let (signed, [a, b, c]): ([VertexId; 4], [Vector3<f64>; 3]) = match primitives {
        Primitives::VertexFace { vertex, face } => {
            let [a, b, c] = mesh.face(face);
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
