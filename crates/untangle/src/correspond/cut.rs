//! Where a patch has to be cut so that it becomes a disc: a tube must be slit open before it can lie flat.
//!
//! The tree of placements joins all faces without closing round a hole. The sides that it does not cross, with the outline of the
//! patch, form a graph that says how the patch closes on itself; once all its dead ends are gone, what is left inside the patch is the cut, and
//! nothing is left in a disc (a tree-cotree decomposition, Eppstein 2003). Since the tree grows along the path, the cut runs
//! where the path does not, unless the path itself goes round.

use super::{patch::Patch, unfold::Unfolding};
use crate::mesh::Mesh;

/// A cut, and the memory to find it.
#[derive(Debug, Default)]
pub(crate) struct Cut {
    /// Pairs of faces with the side of each along which they are cut apart.
    pub(crate) edges: Vec<[(usize, usize); 2]>,
    /// For each face which of its sides belong to the cut.
    pub(crate) sides: Vec<[bool; 3]>,
    degrees: Vec<u32>,
    /// For each vertex the numbers of its edges, by exclusive or: with one edge left, its number.
    traces: Vec<usize>,
    removed: Vec<bool>,
    stack: Vec<u32>,
}

impl Cut {
    /// Finds the cut of an unfolded patch. False where the patch is a disc, or has no outline and no hole.
    ///
    /// Cost: linear in the faces.
    pub(crate) fn find(&mut self, mesh: &Mesh, patch: &Patch, unfolding: &Unfolding) -> bool {
        self.edges.clear();
        self.sides.clear();
        self.sides.resize(patch.faces().len(), [false; 3]);
        self.degrees.clear();
        self.degrees.resize(patch.vertices().len(), 0);
        self.traces.clear();
        self.traces.resize(patch.vertices().len(), 0);
        for (face, corners) in patch.corners().iter().enumerate().filter(|&(face, _)| unfolding.is_reached(face)) {
            for side in 0..3 {
                let beyond = patch.beyond(mesh, face, side);
                if beyond.is_some_and(|beyond| beyond.face < face) || unfolding.tree[face][side] {
                    continue;
                }
                for end in [corners[side], corners[(side + 1) % 3]] {
                    self.degrees[end as usize] += 1;
                    if beyond.is_some() {
                        self.traces[end as usize] ^= self.edges.len();
                    }
                }
                if let Some(beyond) = beyond {
                    self.edges.push([(face, side), (beyond.face, beyond.side)]);
                }
            }
        }
        self.prune(patch);
        let mut number = 0;
        let removed = &self.removed;
        self.edges.retain(|_| {
            number += 1;
            !removed[number - 1]
        });
        for &(face, side) in self.edges.iter().flatten() {
            self.sides[face][side] = true;
        }
        !self.edges.is_empty()
    }

    /// Removes dead ends. The outline has none, so that a vertex of degree 1 has an edge inside the patch.
    fn prune(&mut self, patch: &Patch) {
        self.removed.clear();
        self.removed.resize(self.edges.len(), false);
        self.stack.clear();
        self.stack.extend((0u32..).zip(&self.degrees).filter(|&(_, &degree)| degree == 1).map(|(vertex, _)| vertex));
        while let Some(vertex) = self.stack.pop() {
            if self.degrees[vertex as usize] != 1 {
                continue;
            }
            let edge = self.traces[vertex as usize];
            let Some(&[(face, side), _]) = self.edges.get(edge) else { continue };
            self.removed[edge] = true;
            let corners = patch.corners()[face];
            for end in [corners[side], corners[(side + 1) % 3]] {
                self.degrees[end as usize] -= 1;
                self.traces[end as usize] ^= edge;
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
        let shapes = vec![[Point2::origin(), Point2::new(1.0, 0.0), Point2::new(0.0, 1.0)]; mesh.num_faces()];
        let mut unfolding = Unfolding::default();
        assert!(unfolding.unfold(mesh, &patch, &shapes));
        let mut cut = Cut::default();
        let found = cut.find(mesh, &patch, &unfolding);
        (patch, cut, found)
    }

    #[test]
    fn a_sheet_needs_no_cut_and_a_tube_one_from_rim_to_rim() {
        let (mesh, _) = sheet(7, 5, 0.1);
        assert!(!cut(&mesh).2);
        let mesh = tube(12, 5);
        let (mut patch, found, is_cut) = cut(&mesh);
        assert!(is_cut && found.edges.len() >= 5);
        let before = patch.vertices().len();
        patch.cut(&mesh, &found.sides);
        // The vertices along the cut come twice, and the cut patch has the Euler number of a disc.
        assert_eq!(patch.vertices().len(), before + found.edges.len() + 1);
        let (mut inner, mut rim) = (0, 0);
        for face in 0..patch.faces().len() {
            for side in 0..3 {
                if patch.beyond(&mesh, face, side).is_some() { inner += 1 } else { rim += 1 }
            }
        }
        assert_eq!(patch.vertices().len() + patch.faces().len(), inner / 2 + rim + 1);
        patch.join();
        assert_eq!(patch.vertices().len(), before);
    }
}
