//! Points that move with the cloth.

use nalgebra::Point3;

use crate::{
    frame::Frame,
    mesh::{FaceId, Mesh, VertexId},
    paths::SurfacePoint,
};

/// A point of the cloth that moves with it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaterialPoint {
    /// Vertices of its face. For a point in a vertex all three are that vertex.
    pub vertices: [VertexId; 3],
    /// Weight of each; they sum to 1.
    pub weights: [f64; 3],
}

impl MaterialPoint {
    /// A vertex.
    #[must_use]
    pub fn vertex(vertex: VertexId) -> Self {
        Self { vertices: [vertex; 3], weights: [1.0, 0.0, 0.0] }
    }

    /// The middle of two places of one face; nothing if one of them does not belong to the face.
    #[must_use]
    pub fn middle(mesh: &Mesh, face: FaceId, places: [&SurfacePoint; 2]) -> Option<Self> {
        let [a, b] = [weights_in(mesh, face, places[0])?, weights_in(mesh, face, places[1])?];
        let weights = [0, 1, 2].map(|corner| 0.5 * (a[corner] + b[corner]));
        Some(Self { vertices: mesh.face(face), weights })
    }

    /// World position in metres.
    #[must_use]
    pub fn position(&self, frame: &Frame) -> Point3<f64> {
        let mut sum = Point3::origin();
        for (&vertex, weight) in self.vertices.iter().zip(self.weights) {
            if weight != 0.0 {
                sum += frame.position(vertex).coords * weight;
            }
        }
        sum
    }
}

/// Barycentric coordinates of a place in a face that it belongs to.
pub(crate) fn weights_in(mesh: &Mesh, face: FaceId, place: &SurfacePoint) -> Option<[f64; 3]> {
    let corners = mesh.face(face);
    let corner_of = |vertex| corners.iter().position(|&corner| corner == vertex);
    let mut weights = [0.0; 3];
    match *place {
        SurfacePoint::Vertex(vertex) => weights[corner_of(vertex)?] = 1.0,
        SurfacePoint::Edge { edge, parameter } => {
            let [a, b] = mesh.edge(edge);
            weights[corner_of(a)?] = 1.0 - parameter;
            weights[corner_of(b)?] = parameter;
        }
        SurfacePoint::Face { face: other, barycentric } => {
            if other != face {
                return None;
            }
            weights = barycentric;
        }
    }
    Some(weights)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::correspond::samples::sheet;

    #[test]
    fn middle_of_two_places_of_face_is_their_mean_and_none_beyond_it() {
        let (mesh, flat) = sheet(2, 2, 1.0);
        let positions: Vec<_> = flat.iter().map(|p| [p.x, p.y, 0.0]).collect();
        let frame = Frame::new(&mesh, &positions).unwrap();
        let [a, b, c] = mesh.face(FaceId(0));
        let on_edge = SurfacePoint::Edge { edge: mesh.edge_between(a, b).unwrap(), parameter: 0.25 };
        let middle = MaterialPoint::middle(&mesh, FaceId(0), [&on_edge, &SurfacePoint::Vertex(c)]).unwrap();
        assert!((middle.position(&frame) - Point3::new(0.125, 0.5, 0.0)).norm() < 1e-15);
        assert_eq!(MaterialPoint::vertex(b).position(&frame), Point3::new(1.0, 0.0, 0.0));
        let elsewhere = SurfacePoint::Face { face: FaceId(7), barycentric: [1.0, 0.0, 0.0] };
        assert_eq!(MaterialPoint::middle(&mesh, FaceId(0), [&elsewhere, &on_edge]), None);
    }
}
