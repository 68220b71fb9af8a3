//! Which faces of two leaves share a vertex: taken from the topology once for each mesh.
//!
//! Faces of bodies are left out: no pair of them is searched for.

use super::aabb::WIDTH;
use crate::mesh::{FaceId, Mesh};

/// Vertices of more faces are left out: there the lists would grow with the square of their number.
pub(crate) const MAX_ADJACENT_FACES: usize = 64;

/// Masks of face pairs that share a vertex, for each pair of leaves that has some; stored with the first leaf of the
/// pair.
#[derive(Debug, Default)]
pub(crate) struct LeafAdjacency {
    offsets: Vec<u32>,
    /// The second leaf, and bit `8 i + k` for faces `i` of the first leaf and `k` of the second that share a vertex.
    masks: Vec<(u32, u64)>,
    has_bodies: bool,
    has_hubs: bool,
}

impl LeafAdjacency {
    /// For faces in the order of the tree. Cost: linear in the faces.
    pub(crate) fn new(mesh: &Mesh, order: &[FaceId]) -> Self {
        let mut place_of = vec![u32::MAX; mesh.num_faces()];
        for (place, face) in (0..).zip(order) {
            place_of[face.index()] = place;
        }
        let mut adjacency = Self { offsets: vec![0], ..Self::default() };
        for (leaf, faces) in (0..).zip(order.chunks(WIDTH)) {
            let first = adjacency.masks.len();
            for (slot, &face) in faces.iter().enumerate() {
                if mesh.is_body_face(face) {
                    adjacency.has_bodies = true;
                    continue;
                }
                for vertex in mesh.face(face) {
                    let around = mesh.vertex_faces(vertex);
                    if around.len() > MAX_ADJACENT_FACES {
                        adjacency.has_hubs = true;
                        continue;
                    }
                    for other in around.iter().map(|other| place_of[other.index()]) {
                        let (other_leaf, other_slot) = (other / 8, other % 8);
                        if other_leaf >= leaf {
                            adjacency.add(first, other_leaf, 1 << (8 * slot + other_slot as usize));
                        }
                    }
                }
            }
            adjacency.masks[first..].sort_unstable();
            adjacency.offsets.push(u32::try_from(adjacency.masks.len()).expect("at most 64 for each corner"));
        }
        adjacency
    }

    /// Sets a bit in the mask with leaf `second` among those from `first` on.
    fn add(&mut self, first: usize, second: u32, bit: u64) {
        match self.masks[first..].iter_mut().find(|(leaf, _)| *leaf == second) {
            Some((_, mask)) => *mask |= bit,
            None => self.masks.push((second, bit)),
        }
    }

    /// The mask of face pairs that share a vertex, of two leaves, the first not after the second.
    #[inline(always)]
    pub(crate) fn mask(&self, a: u32, b: u32) -> u64 {
        let row = &self.masks[self.offsets[a as usize] as usize..self.offsets[a as usize + 1] as usize];
        row.iter().find(|&&(leaf, _)| leaf == b).map_or(0, |&(_, mask)| mask)
    }

    /// Whether pairs around vertices of more than [`MAX_ADJACENT_FACES`] faces, or pairs of faces of bodies, are
    /// missing from the masks.
    pub(crate) fn is_incomplete(&self) -> bool {
        self.has_bodies || self.has_hubs
    }

    /// Whether there are vertices of cloth of more than [`MAX_ADJACENT_FACES`] faces.
    pub(crate) fn has_hubs(&self) -> bool {
        self.has_hubs
    }
}
