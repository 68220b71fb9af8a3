//! Outward normals of a surface at points of it.

use nalgebra::{Point3, Vector3};

use crate::mesh::{FaceId, Mesh, VertexId};

/// A weight of a corner below this is none: the point lies on the opposite edge.
const NONE: f64 = 1e-9;

/// Normals of the faces of a state, each turned outwards.
#[derive(Clone, Copy, Debug)]
pub(super) struct OutwardNormals<'a> {
    pub(super) mesh: &'a Mesh,
    pub(super) positions: &'a [Point3<f64>],
    /// For each face whether its normal points outwards as it is given.
    pub(super) outwards: &'a [bool],
}

impl OutwardNormals<'_> {
    /// The outward pseudonormal at a point of a face; nothing on the boundary.
    pub(super) fn normal(&self, face: FaceId, weights: [f64; 3]) -> Option<Vector3<f64>> {
        let (mesh, corners) = (self.mesh, self.mesh.face(face));
        let used: Vec<VertexId> = (0..3).filter(|&k| weights[k] > NONE).map(|k| corners[k]).collect();
        let sum: Vector3<f64> = match *used {
            [vertex] if mesh.is_boundary_vertex(vertex) => return None,
            [vertex] => mesh.vertex_faces(vertex).iter().map(|&face| self.unit(face) * self.angle(face, vertex)).sum(),
            [a, b] => {
                let edge = mesh.edge_between(a, b)?;
                if mesh.is_boundary_edge(edge) {
                    return None;
                }
                mesh.edge_faces(edge).iter().map(|&face| self.unit(face)).sum()
            }
            _ => self.unit(face),
        };
        sum.try_normalize(1e-12)
    }

    /// The outward unit normal of a face; zero where it has no area.
    pub(super) fn unit(&self, face: FaceId) -> Vector3<f64> {
        let [a, b, c] = self.mesh.face(face).map(|vertex| self.positions[vertex.index()]);
        let unit = (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_else(Vector3::zeros);
        if self.outwards[face.index()] { unit } else { -unit }
    }

    fn angle(&self, face: FaceId, vertex: VertexId) -> f64 {
        let corners = self.mesh.face(face);
        let at = corners.iter().position(|&corner| corner == vertex).unwrap_or_default();
        let [a, b, c] = [0, 1, 2].map(|k| self.positions[corners[(at + k) % 3].index()]);
        let (u, v) = (b - a, c - a);
        libm::atan2(u.cross(&v).norm(), u.dot(&v))
    }
}
