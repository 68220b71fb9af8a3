//! Normals that agree from face to face, for any winding of the input.

use nalgebra::Vector3;

use crate::{
    correspond::MaterialPoint,
    frame::Frame,
    mesh::{FaceId, Mesh, VertexId},
};

/// For each face whether its winding is reversed, so that neighbours agree wherever the surface has two sides.
#[derive(Debug)]
pub(crate) struct Orientation {
    is_reversed: Vec<bool>,
}

impl Orientation {
    /// Walks over every piece once, from its lowest face. Cost: linear in the faces.
    pub(crate) fn of(mesh: &Mesh) -> Self {
        let mut is_reversed = vec![false; mesh.num_faces()];
        let mut reached = vec![false; mesh.num_faces()];
        let mut stack = Vec::new();
        for first in mesh.face_ids() {
            if reached[first.index()] {
                continue;
            }
            reached[first.index()] = true;
            stack.push(first);
            while let Some(face) = stack.pop() {
                for edge in mesh.face_edges(face).into_iter().flatten() {
                    let &[one, other] = mesh.edge_faces(edge) else { continue };
                    let next = if one == face { other } else { one };
                    if !std::mem::replace(&mut reached[next.index()], true) {
                        let [a, b] = mesh.edge(edge);
                        let agree = runs(mesh, face, a, b) != runs(mesh, next, a, b);
                        is_reversed[next.index()] = is_reversed[face.index()] == agree;
                        stack.push(next);
                    }
                }
            }
        }
        Self { is_reversed }
    }

    /// Whether the winding of a face is reversed.
    pub(crate) fn is_reversed(&self, face: FaceId) -> bool {
        self.is_reversed[face.index()]
    }

    /// Twice the area vector of a face.
    pub(crate) fn area(&self, mesh: &Mesh, frame: &Frame, face: FaceId) -> Vector3<f64> {
        let [a, b, c] = mesh.face(face).map(|vertex| frame.position(vertex));
        let area = (b - a).cross(&(c - a));
        if self.is_reversed[face.index()] { -area } else { area }
    }

    /// The unit normal at a point: the mean over the faces round its corners. Nothing where the faces have no area.
    pub(crate) fn normal(&self, mesh: &Mesh, frame: &Frame, at: &MaterialPoint) -> Option<Vector3<f64>> {
        let mut sum = Vector3::zeros();
        for (&vertex, weight) in at.vertices.iter().zip(at.weights).filter(|(_, weight)| *weight > 0.0) {
            let around: Vector3<f64> = mesh.vertex_faces(vertex).iter().map(|&face| self.area(mesh, frame, face)).sum();
            if let Some(unit) = around.try_normalize(0.0) {
                sum += unit * weight;
            }
        }
        sum.try_normalize(1e-9)
    }
}

/// Whether a face runs along an edge from `a` to `b`.
fn runs(mesh: &Mesh, face: FaceId, a: VertexId, b: VertexId) -> bool {
    let corners = mesh.face(face);
    (0..3).any(|corner| corners[corner] == a && corners[(corner + 1) % 3] == b)
}
