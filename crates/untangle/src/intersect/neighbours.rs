//! Which faces of two leaves share a vertex: known from the topology, listed once.

use super::boxes::WIDTH;
use crate::mesh::{FaceId, Mesh};

/// Round a vertex of more faces than this the list would grow with their square: pairs there are told apart when they are met.
pub(crate) const MOST_FACES: usize = 64;

/// For each leaf the leaves from itself on that have neighbours in it.
#[derive(Debug, Default)]
pub(crate) struct Neighbours {
    offsets: Vec<u32>,
    /// A leaf, and a bit for each pair that shares a vertex: bit `8 i + k` for faces `i` of the row's leaf and `k` of this one.
    leaves: Vec<(u32, u64)>,
    are_incomplete: bool,
}

impl Neighbours {
    /// For faces in the order of a tree. Cost: linear in the faces.
    pub(crate) fn new(mesh: &Mesh, order: &[FaceId]) -> Self {
        let mut place_of = vec![u32::MAX; mesh.num_faces()];
        for (place, face) in (0..).zip(order) {
            place_of[face.index()] = place;
        }
        let mut neighbours = Self { offsets: vec![0], ..Self::default() };
        for (leaf, faces) in (0..).zip(order.chunks(WIDTH)) {
            let first = neighbours.leaves.len();
            for (slot, &face) in faces.iter().enumerate() {
                for vertex in mesh.face(face) {
                    let around = mesh.vertex_faces(vertex);
                    if around.len() > MOST_FACES {
                        neighbours.are_incomplete = true;
                        continue;
                    }
                    for other in around.iter().map(|other| place_of[other.index()]) {
                        let (other_leaf, other_slot) = (other / 8, other % 8);
                        if other_leaf < leaf {
                            continue;
                        }
                        let bit = 1 << (8 * slot + other_slot as usize);
                        match neighbours.leaves[first..].iter_mut().find(|(known, _)| *known == other_leaf) {
                            Some((_, bits)) => *bits |= bit,
                            None => neighbours.leaves.push((other_leaf, bit)),
                        }
                    }
                }
            }
            neighbours.leaves[first..].sort_unstable();
            neighbours.offsets.push(u32::try_from(neighbours.leaves.len()).expect("at most 64 for each corner"));
        }
        neighbours
    }

    /// The pairs of faces of two leaves, the first not after the second, that share a vertex.
    #[inline(always)]
    pub(crate) fn between(&self, a: u32, b: u32) -> u64 {
        let row = &self.leaves[self.offsets[a as usize] as usize..self.offsets[a as usize + 1] as usize];
        row.iter().find(|&&(leaf, _)| leaf == b).map_or(0, |&(_, bits)| bits)
    }

    /// Whether pairs round vertices of very many faces are missing.
    pub(crate) fn are_incomplete(&self) -> bool {
        self.are_incomplete
    }
}
