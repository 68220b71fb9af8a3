//! Which face of the tree tests a vertex or an edge: the first one that has it, so that no pair is tested twice.

use crate::{
    intersect::Bvh,
    mesh::{EdgeId, FaceId, Mesh, VertexId},
};

/// The vertices and edges of each face of the tree that no face before it has.
#[derive(Debug, Default)]
pub(super) struct Owners {
    /// For each place in the order of the tree one bit for each corner, and above them one for each edge.
    masks: Vec<u8>,
}

impl Owners {
    /// Cost: linear in the faces.
    pub(super) fn new(mesh: &Mesh, bvh: &Bvh) -> Self {
        let (mut has_vertex, mut has_edge) = (vec![false; mesh.num_vertices()], vec![false; mesh.num_edges()]);
        let mask = |&face: &FaceId| {
            let mut mask = 0;
            for (corner, vertex) in mesh.face(face).into_iter().enumerate() {
                if !std::mem::replace(&mut has_vertex[vertex.0 as usize], true) {
                    mask |= 1 << corner;
                }
            }
            for (side, edge) in mesh.face_edges(face).into_iter().flatten().enumerate() {
                if !std::mem::replace(&mut has_edge[edge.0 as usize], true) {
                    mask |= 8 << side;
                }
            }
            mask
        };
        Self { masks: bvh.faces().iter().map(mask).collect() }
    }

    /// The corners that the face at a place owns, and its three corners.
    #[inline(always)]
    pub(super) fn vertices(&self, place: u32, corners: [VertexId; 3]) -> impl Iterator<Item = VertexId> {
        let mask = self.masks[place as usize];
        corners.into_iter().enumerate().filter(move |(corner, _)| mask >> corner & 1 == 1).map(|(_, vertex)| vertex)
    }

    /// The sides that the face at a place owns: side `k` joins corners `k` and `k + 1`.
    #[inline(always)]
    pub(super) fn sides(&self, place: u32) -> impl Iterator<Item = usize> + Clone + use<> {
        let mask = self.masks[place as usize];
        (0..3).filter(move |side| mask >> (3 + side) & 1 == 1)
    }
}

/// The edge of a side of a face of the tree.
pub(super) fn edge_of(mesh: &Mesh, face: FaceId, side: usize) -> EdgeId {
    mesh.face_edges(face).unwrap_or_else(|| unreachable!("the tree holds no ignored face, but {face:?}"))[side]
}
