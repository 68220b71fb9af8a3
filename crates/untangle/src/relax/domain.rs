//! The part of the cloth that may move in one iteration, with numbers of its own.

use std::sync::OnceLock;

use faer::{
    Side,
    sparse::{
        SparseColMat,
        linalg::solvers::{Llt, SymbolicLlt},
    },
};

use crate::mesh::{Mesh, VertexId};

const ABSENT: u32 = u32::MAX;

/// Vertices within some rings of where something is to be done, pinned ones left out, in ascending order.
///
/// The table over the whole mesh is made once and wiped by undoing.
#[derive(Debug, Default)]
pub(super) struct Domain {
    vertices: Vec<VertexId>,
    index: Vec<u32>,
    front: Vec<VertexId>,
    /// The symbolic part of the first factorisation over this domain: all others have the same pattern.
    symbolic: OnceLock<Option<SymbolicLlt<usize>>>,
}

impl Domain {
    /// Takes the vertices within `rings` edges of `seeds`.
    pub(super) fn grow(&mut self, mesh: &Mesh, seeds: impl Iterator<Item = VertexId>, rings: usize) {
        self.symbolic.take();
        for vertex in self.vertices.drain(..) {
            self.index[vertex.index()] = ABSENT;
        }
        self.index.resize(mesh.num_vertices(), ABSENT);
        self.front.clear();
        for seed in seeds {
            self.reach(seed);
        }
        let mut first = 0;
        for _ in 0..rings {
            let last = self.front.len();
            if first == last {
                break;
            }
            for slot in first..last {
                let vertex = self.front[slot];
                for &edge in mesh.vertex_edges(vertex) {
                    self.reach(mesh.opposite_vertex(edge, vertex));
                }
            }
            first = last;
        }
        for &vertex in &self.front {
            self.index[vertex.index()] = ABSENT;
        }
        self.vertices.extend(self.front.iter().copied().filter(|&vertex| !mesh.is_pinned(vertex)));
        self.vertices.sort_unstable();
        for (slot, vertex) in (0u32..).zip(&self.vertices) {
            self.index[vertex.index()] = slot;
        }
    }

    fn reach(&mut self, vertex: VertexId) {
        let slot = &mut self.index[vertex.index()];
        if *slot == ABSENT {
            *slot = 0;
            self.front.push(vertex);
        }
    }

    /// The vertices, ascending.
    pub(super) fn vertices(&self) -> &[VertexId] {
        &self.vertices
    }

    /// The number of a vertex here; nothing for one that must not move.
    pub(super) fn local(&self, vertex: VertexId) -> Option<usize> {
        let slot = self.index[vertex.index()];
        (slot != ABSENT).then_some(slot as usize)
    }

    /// Factorises a symmetric matrix, of which the lower half is given, over the vertices of this domain. Its pattern must be that of all
    /// others over this domain. Nothing where the numbers don't allow it.
    pub(super) fn factorise(&self, matrix: &SparseColMat<usize, f64>) -> Option<Llt<usize, f64>> {
        let symbolic = self.symbolic.get_or_init(|| SymbolicLlt::try_new(matrix.symbolic(), Side::Lower).ok());
        Llt::try_new_with_symbolic(symbolic.clone()?, matrix.as_ref(), Side::Lower).ok()
    }
}
