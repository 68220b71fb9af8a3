//! The vertices that may move in one iteration, with numbers of their own.

use std::sync::OnceLock;

use crate::{
    correspond::{Cholesky, SparseSymmetric},
    mesh::{Mesh, VertexId},
    sparse_map::SparseMap,
};

/// The vertices of a k-ring round some seeds, pinned ones left out, in ascending order. The number of a vertex is its
/// place in that order.
#[derive(Debug, Default)]
pub(crate) struct Domain {
    /// The number of each free vertex. While the domain grows: every vertex that was reached.
    numbers: SparseMap<VertexId, u32>,
    /// Memory of [`Domain::grow`].
    free: Vec<VertexId>,
    /// The order of elimination of the first factorisation over this domain: all others have the same pattern.
    order: OnceLock<Vec<usize>>,
}

impl Domain {
    /// Takes the vertices within `rings` edges of `seeds`.
    ///
    /// Cost: linear in the vertices that are reached, and their sorting.
    pub(crate) fn grow(&mut self, mesh: &Mesh, seeds: impl Iterator<Item = VertexId>, rings: usize) {
        self.order.take();
        self.numbers.reset(mesh.num_vertices());
        for seed in seeds {
            self.numbers.insert(seed, 0);
        }
        let mut first = 0;
        for _ in 0..rings {
            let last = self.numbers.keys().len();
            if first == last {
                break;
            }
            for index in first..last {
                let vertex = self.numbers.keys()[index];
                for &edge in mesh.vertex_edges(vertex) {
                    self.numbers.insert(mesh.opposite_vertex(edge, vertex), 0);
                }
            }
            first = last;
        }
        self.free.clear();
        self.free.extend(self.numbers.keys().iter().copied().filter(|&vertex| !mesh.is_pinned(vertex)));
        self.free.sort_unstable();
        self.numbers.reset(mesh.num_vertices());
        for (number, &vertex) in (0u32..).zip(&self.free) {
            self.numbers.set(vertex, number);
        }
    }

    /// The vertices, ascending.
    pub(crate) fn vertices(&self) -> &[VertexId] {
        self.numbers.keys()
    }

    /// The number of a vertex here; nothing for one that must not move.
    pub(crate) fn local(&self, vertex: VertexId) -> Option<usize> {
        self.numbers.get(vertex).map(|number| number as usize)
    }

    /// Factorises a compressed matrix over the vertices of this domain. Its pattern must be that of all others over
    /// this domain. Nothing where the numbers don't allow it.
    pub(crate) fn factorise(&self, matrix: &SparseSymmetric) -> Option<Cholesky> {
        let order = self.order.get_or_init(|| Cholesky::order_of(matrix));
        let mut factor = Cholesky::default();
        factor.factorise_in_order(matrix, order).then_some(factor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::MeshDescription;

    #[test]
    fn domain_grown_again_holds_only_free_vertices_of_the_new_rings() {
        let faces = vec![[0, 1, 2], [1, 3, 2], [2, 3, 4]];
        let mesh = Mesh::new(MeshDescription { num_vertices: 5, faces, pins: vec![1], ..Default::default() }).unwrap();
        let mut domain = Domain::default();
        let local = |domain: &Domain| [0, 1, 2, 3, 4].map(|vertex| domain.local(VertexId(vertex)));
        domain.grow(&mesh, [VertexId(0)].into_iter(), 1);
        assert_eq!(domain.vertices(), [VertexId(0), VertexId(2)]);
        assert_eq!(local(&domain), [Some(0), None, Some(1), None, None]);
        domain.grow(&mesh, [VertexId(4), VertexId(3)].into_iter(), 0);
        assert_eq!(domain.vertices(), [VertexId(3), VertexId(4)]);
        assert_eq!(local(&domain), [None, None, None, Some(0), Some(1)]);
        domain.grow(&mesh, [VertexId(3)].into_iter(), usize::MAX);
        assert_eq!(local(&domain), [Some(0), None, Some(1), Some(2), Some(3)]);
    }
}
