//! The sides along which a patch is cut into a disc: a tube must be slit open before it can lie flat.
//!
//! Tree-cotree decomposition (Eppstein 2003): the spanning tree of the unfolding joins all faces without closing round
//! a hole. The sides that it does not cross, with the outline of the patch, form a graph that says how the patch closes
//! on itself. Once all dead ends of that graph are pruned, the sides that remain inside the patch are the cut; in a
//! disc none remain. Since the tree grows along the path, the cut runs where the path does not, unless the path itself
//! winds round.

use super::{patch::Patch, unfolding::Unfolding};

/// A cut, and the memory to find it.
#[derive(Debug, Default)]
pub(super) struct Cut {
    /// Pairs of faces that are cut apart, each with its side of the cut.
    pub(super) edges: Vec<[(usize, usize); 2]>,
    /// For each face which of its sides belong to the cut.
    pub(super) sides: Vec<[bool; 3]>,
    /// For each vertex how many edges of the graph it has.
    degrees: Vec<u32>,
    /// For each vertex the exclusive or of the indices of its edges: where one edge remains, its index.
    edges_xor: Vec<usize>,
    is_pruned: Vec<bool>,
    stack: Vec<u32>,
}

impl Cut {
    /// Finds the cut of an unfolded patch. False where it needs none: the patch is a disc, or closed without a handle.
    ///
    /// Cost: linear in the faces.
    pub(super) fn find(&mut self, patch: &Patch, unfolding: &Unfolding) -> bool {
        self.edges.clear();
        self.sides.clear();
        self.sides.resize(patch.faces().len(), [false; 3]);
        self.degrees.clear();
        self.degrees.resize(patch.vertices().len(), 0);
        self.edges_xor.clear();
        self.edges_xor.resize(patch.vertices().len(), 0);
        self.collect_cotree(patch, unfolding);
        self.prune(patch);
        let mut is_pruned = self.is_pruned.iter();
        self.edges.retain(|_| is_pruned.next() == Some(&false));
        for &(face, side) in self.edges.iter().flatten() {
            self.sides[face][side] = true;
        }
        !self.edges.is_empty()
    }

    /// Makes the graph of all sides that the tree does not cross, with the outline.
    fn collect_cotree(&mut self, patch: &Patch, unfolding: &Unfolding) {
        for (face, corners) in patch.corners().iter().enumerate().filter(|&(face, _)| unfolding.is_reached(face)) {
            for side in 0..3 {
                let neighbour = patch.neighbour(face, side);
                if neighbour.is_some_and(|neighbour| neighbour.face < face) || unfolding.tree[face][side] {
                    continue;
                }
                for end in [corners[side], corners[(side + 1) % 3]] {
                    self.degrees[end as usize] += 1;
                    if neighbour.is_some() {
                        self.edges_xor[end as usize] ^= self.edges.len();
                    }
                }
                if let Some(neighbour) = neighbour {
                    self.edges.push([(face, side), (neighbour.face, neighbour.side)]);
                }
            }
        }
    }

    /// Removes dead ends. The outline has none, so that a vertex of degree 1 has an edge inside the patch.
    fn prune(&mut self, patch: &Patch) {
        self.is_pruned.clear();
        self.is_pruned.resize(self.edges.len(), false);
        self.stack.clear();
        self.stack.extend((0u32..).zip(&self.degrees).filter(|&(_, &degree)| degree == 1).map(|(vertex, _)| vertex));
        while let Some(vertex) = self.stack.pop() {
            if self.degrees[vertex as usize] != 1 {
                continue;
            }
            let edge = self.edges_xor[vertex as usize];
            let Some(&[(face, side), _]) = self.edges.get(edge) else { continue };
            self.is_pruned[edge] = true;
            let corners = patch.corners()[face];
            for end in [corners[side], corners[(side + 1) % 3]] {
                self.degrees[end as usize] -= 1;
                self.edges_xor[end as usize] ^= edge;
                if self.degrees[end as usize] == 1 {
                    self.stack.push(end);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Point2;

    use super::*;
    use crate::{
        correspond::samples::{sheet, tube},
        mesh::Mesh,
    };

    fn cut(mesh: &Mesh) -> (Patch, Cut, bool) {
        let mut patch = Patch::default();
        patch.start(mesh, mesh.face_ids());
        patch.connect(mesh);
        let shapes = vec![[Point2::origin(), Point2::new(1.0, 0.0), Point2::new(0.0, 1.0)]; mesh.num_faces()];
        let mut unfolding = Unfolding::default();
        assert!(unfolding.unfold(&patch, &shapes));
        let mut cut = Cut::default();
        let found = cut.find(&patch, &unfolding);
        (patch, cut, found)
    }

    #[test]
    fn cut_of_disc_is_empty() {
        let (mesh, _) = sheet(7, 5, 0.1);
        assert!(!cut(&mesh).2);
    }

    #[test]
    fn cut_of_tube_runs_from_rim_to_rim_and_leaves_a_disc() {
        let mesh = tube(12, 5);
        let (mut patch, found, is_cut) = cut(&mesh);
        assert!(is_cut && found.edges.len() >= 5);
        let before = patch.vertices().len();
        patch.cut(&found.sides);
        // The vertices along the cut come twice, and the cut patch has the Euler number of a disc.
        assert_eq!(patch.vertices().len(), before + found.edges.len() + 1);
        let (mut inner, mut rim) = (0, 0);
        for face in 0..patch.faces().len() {
            for side in 0..3 {
                if patch.neighbour(face, side).is_some() { inner += 1 } else { rim += 1 }
            }
        }
        assert_eq!(patch.vertices().len() + patch.faces().len(), inner / 2 + rim + 1);
        patch.undo_cut();
        assert_eq!(patch.vertices().len(), before);
    }
}
