//! Ends where two boundaries touch exactly: the only source of BLB and BB/BB, and of BB/BI without a loop vertex.
//!
//! Perturbed signs know no touching: on the perturbed input the boundary edge pierces the face just inside its
//! boundary, or misses it. Here the unperturbed coordinates are compared, with exact arithmetic. The answer decides the
//! type of a path only; it changes no intersection.

use super::SurfacePoint;
use crate::{
    frame::Frame,
    intersect::EdgeFaceIntersection,
    mesh::{EdgeId, Mesh, VertexId},
    predicates::are_coplanar,
};

/// Where a boundary edge touches the boundary of the face that it pierces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Contact {
    /// Place on the pierced sheet: on a boundary edge, or in a boundary vertex.
    pub(crate) on_face: SurfacePoint,
}

/// The element of the boundary that is touched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum TouchedElement {
    Vertex(VertexId),
    Edge(EdgeId),
}

impl Contact {
    /// The contact at an edge-face intersection, if the edge touches the face's boundary exactly there.
    pub(crate) fn at(mesh: &Mesh, frame: &Frame, crossing: &EdgeFaceIntersection) -> Option<Self> {
        let position = |vertex: VertexId| -> [f64; 3] { frame.position(vertex).coords.into() };
        let [p, q] = mesh.edge(crossing.edge);
        let [a, b, c] = mesh.face(crossing.face);
        let in_plane = [p, q].map(|end| are_coplanar([a, b, c, end].map(position)));
        if in_plane == [true; 2] {
            // The edge lies in the plane of the face: no single point to name.
            return None;
        }
        // The line of the edge meets the plane in one point, inside the face or on its border. It is on the line of a
        // side exactly where these two lines are coplanar.
        let sides = mesh.face_edges(crossing.face)?;
        let touched = sides.map(|side| {
            let [f, g] = mesh.edge(side);
            are_coplanar([p, q, f, g].map(position))
        });
        let touched_element = match touched {
            [true, false, false] | [false, true, false] | [false, false, true] => {
                let side = sides[touched.iter().position(|&touches| touches)?];
                mesh.is_boundary_edge(side).then_some(TouchedElement::Edge(side))?
            }
            [true, true, false] => Self::vertex(mesh, b)?,
            [false, true, true] => Self::vertex(mesh, c)?,
            [true, false, true] => Self::vertex(mesh, a)?,
            _ => return None,
        };
        let on_face = match touched_element {
            TouchedElement::Vertex(vertex) => SurfacePoint::Vertex(vertex),
            TouchedElement::Edge(edge) => SurfacePoint::Edge { edge, parameter: Self::parameter(mesh, crossing, edge) },
        };
        Some(Self { on_face })
    }

    /// A vertex, if it is on the boundary.
    fn vertex(mesh: &Mesh, vertex: VertexId) -> Option<TouchedElement> {
        mesh.is_boundary_vertex(vertex).then_some(TouchedElement::Vertex(vertex))
    }

    /// Position along a side of the pierced face.
    fn parameter(mesh: &Mesh, crossing: &EdgeFaceIntersection, edge: EdgeId) -> f64 {
        let weight = |vertex: VertexId| {
            let corner = mesh.face(crossing.face).into_iter().position(|corner| corner == vertex);
            corner.map_or(0.0, |corner| crossing.barycentric[corner])
        };
        let [first, second] = mesh.edge(edge).map(weight);
        if first + second > 0.0 { second / (first + second) } else { 0.5 }
    }
}
