//! Which face answers for a vertex or an edge: the first that has it, in the order of the tree. So each pair of
//! primitives belongs to one pair of faces, and none is tested twice (Curtis, Tamstorf and Manocha 2008).

use crate::{
    intersect::Bvh,
    mesh::{EdgeId, FaceId, Mesh, VertexId},
};

/// What each face answers for.
#[derive(Debug, Default)]
pub(super) struct Owners {
    /// By place in the order of the tree: bit `k` for corner `k`, and bit `3 + k` for the edge to the next corner.
    owned: Vec<u8>,
    edges: Vec<[EdgeId; 3]>,
    places: Vec<u32>,
}

impl Owners {
    /// Shares out the vertices and edges of a mesh.
    ///
    /// Cost: linear in the faces.
    pub(super) fn new(mesh: &Mesh, bvh: &Bvh) -> Self {
        let (mut has_vertex, mut has_edge) = (vec![false; mesh.num_vertices()], vec![false; mesh.num_edges()]);
        let mut owners = Self { places: vec![u32::MAX; mesh.num_faces()], ..Self::default() };
        for (place, &face) in (0..).zip(bvh.faces()) {
            let edges = mesh.face_edges(face).expect("the tree has used faces only");
            let mut owned = 0;
            for (corner, vertex) in mesh.face(face).into_iter().enumerate() {
                let is_new = |has: &mut bool| u8::from(!std::mem::replace(has, true));
                owned |= is_new(&mut has_vertex[vertex.index()]) << corner;
                owned |= is_new(&mut has_edge[edges[corner].index()]) << (3 + corner);
            }
            owners.owned.push(owned);
            owners.edges.push(edges);
            owners.places[face.index()] = place;
        }
        owners
    }

    /// The place of a face.
    pub(super) fn place(&self, face: FaceId) -> u32 {
        self.places[face.index()]
    }

    /// The vertices that a face answers for.
    #[inline(always)]
    pub(super) fn vertices(&self, bvh: &Bvh, place: u32) -> impl Iterator<Item = VertexId> + Clone {
        let (owned, corners) = (self.owned[place as usize], bvh.corners(place));
        (0..3).filter(move |corner| owned >> corner & 1 == 1).map(move |corner| corners[corner])
    }

    /// The edges that a face answers for, each with its ends.
    #[inline(always)]
    pub(super) fn edges(&self, bvh: &Bvh, place: u32) -> impl Iterator<Item = (EdgeId, [VertexId; 2])> + Clone {
        let (owned, corners, edges) = (self.owned[place as usize], bvh.corners(place), self.edges[place as usize]);
        let ends = move |corner: usize| (edges[corner], [corners[corner], corners[(corner + 1) % 3]]);
        (0..3).filter(move |corner| owned >> (3 + corner) & 1 == 1).map(ends)
    }
}
