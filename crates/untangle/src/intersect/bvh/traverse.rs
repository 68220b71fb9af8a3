//! Traversal of the tree against itself: pairs of faces whose boxes overlap.

use super::{
    aabb::WIDTH,
    tree::{Bvh, NodePair},
};
use crate::simd::{InstructionSet, Portable};

/// Of the bits `8 i + k` of pairs of slots, those with `i < k`, and those with `i = k`.
pub(super) const ABOVE_DIAGONAL: u64 = 0x0080_c0e0_f0f8_fcfe;
pub(super) const DIAGONAL: u64 = 0x8040_2010_0804_0201;

impl Bvh {
    /// Splits the traversal into independent pairs of subtrees: the nodes of the topmost level that has `min_nodes` of
    /// them, each against itself and against the later ones that it overlaps.
    pub(crate) fn subtree_pairs(&self, min_nodes: usize, pairs: &mut Vec<NodePair>) {
        pairs.clear();
        let Some(level) = (0..self.levels.len()).rev().find(|&level| self.levels[level].len() >= min_nodes) else {
            pairs.extend(self.root_pair());
            return;
        };
        let num_nodes = u32::try_from(self.levels[level].len()).expect("fewer nodes than faces");
        pairs.extend((0..num_nodes).map(|node| NodePair { level, nodes: [node, node] }));
        // The level has more than one node, so that there is one above it.
        for a in 0..num_nodes {
            let aabb = self.aabb(level, a);
            for (parent, boxes) in (0..).zip(&self.levels[level + 1]).skip(a as usize / WIDTH) {
                let mut hits = boxes.overlap_mask(Portable, &aabb);
                while hits != 0 {
                    let b = 8 * parent + hits.trailing_zeros();
                    hits &= hits - 1;
                    if b > a {
                        pairs.push(NodePair { level, nodes: [a, b] });
                    }
                }
            }
        }
    }

    /// Goes on with a traversal of pairs of nodes, those on the stack, and appends each pair of faces below them whose
    /// boxes overlap once, except for those that share a vertex. Ends after as many visits, or pairs and a few more, as
    /// allowed, and returns the number of visits. Faces are named by their places in the order of the tree.
    #[inline(always)]
    pub(crate) fn overlapping_faces(
        &self,
        simd: impl InstructionSet,
        stack: &mut Vec<NodePair>,
        [max_pairs, max_visits]: [usize; 2],
        found: &mut Vec<[u32; 2]>,
    ) -> usize {
        let mut num_visits = 0;
        while found.len() < max_pairs && num_visits < max_visits {
            let Some(NodePair { level, nodes: [a, b] }) = stack.pop() else { break };
            num_visits += 1;
            if self.have_common_hub(level, a, b) {
                continue;
            }
            let boxes = &self.levels[level];
            let mut pairs = boxes[a as usize].overlap_mask_x8(simd, &boxes[b as usize]);
            if a == b {
                // Each pair once; a node with itself only above the leaves.
                pairs &= if level == 0 { ABOVE_DIAGONAL } else { ABOVE_DIAGONAL | DIAGONAL };
            }
            if level == 0 {
                pairs &= !self.adjacency.mask(a, b);
            }
            while pairs != 0 {
                let (slot, other) = (pairs.trailing_zeros() / 8, pairs.trailing_zeros() % 8);
                pairs &= pairs - 1;
                let children = [8 * a + slot, 8 * b + other];
                if level == 0 {
                    found.push(children);
                } else {
                    stack.push(NodePair { level: level - 1, nodes: children });
                }
            }
        }
        num_visits
    }
}
