//! One face as the exact tests see it.

use crate::{
    frame::Frame,
    mesh::{EdgeId, FaceId, Mesh, VertexId},
    predicates::{Plane, Side, Site},
};

/// A face with the positions of its corners.
#[derive(Debug)]
pub(super) struct Corners {
    pub(super) face: FaceId,
    /// The corner of the mesh's face that stands first here.
    first: usize,
    pub(super) vertices: [VertexId; 3],
    pub(super) sites: [Site; 3],
}

impl Corners {
    pub(super) fn of(mesh: &Mesh, frame: &Frame, face: FaceId) -> Self {
        let vertices = mesh.face(face);
        let [a, b, c] = vertices;
        Self { face, first: 0, vertices, sites: [frame.site(a), frame.site(b), frame.site(c)] }
    }

    /// The same face with its corners rotated so that `vertex` stands first.
    pub(super) fn from(mut self, vertex: VertexId) -> Self {
        self.first = self.vertices.iter().position(|&corner| corner == vertex).unwrap_or_default();
        self.vertices.rotate_left(self.first);
        self.sites.rotate_left(self.first);
        self
    }

    pub(super) fn plane(&self) -> Plane {
        Plane::through(self.sites)
    }

    /// The sides of a plane on which the corners lie.
    #[inline]
    pub(super) fn sides_of(&self, plane: &Plane) -> [Side; 3] {
        let [a, b, c] = self.sites;
        [plane.side_of(a), plane.side_of(b), plane.side_of(c)]
    }

    /// The edge from a corner to the next.
    pub(super) fn edge_at(&self, mesh: &Mesh, corner: usize) -> EdgeId {
        let Some(edges) = mesh.face_edges(self.face) else { panic!("ignored face {} is tested", self.face.0) };
        edges[(corner + self.first) % 3]
    }
}
