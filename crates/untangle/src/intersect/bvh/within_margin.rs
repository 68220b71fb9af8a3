//! Pairs within a margin of each other: for separation certificates that are to last, and for distances.

use std::ops::Range;

use super::{
    aabb::{Aabb, AabbX8, WIDTH, max},
    traverse::{ABOVE_DIAGONAL, DIAGONAL},
    tree::{Bvh, NodePair},
};
use crate::{
    frame::Frame,
    mesh::VertexId,
    simd::{InstructionSet, Portable},
};

impl Bvh {
    /// A margin in metres after the map into single precision, and more than the roundings of both boxes. Far vertices
    /// have [`FAR_ROUNDING`] beside it.
    pub(crate) fn margin_f32(&self, margin_m: f64) -> f32 {
        #[expect(clippy::cast_possible_truncation, reason = "more than the rounding is added")]
        let margin = (margin_m * self.scale * (1.0 + 1e-6) + 1e-6) as f32;
        if margin < 0.25 * f32::MAX {
            margin
        } else if self.has_far {
            // Far coordinates end where single precision does, as grown boxes do: with this all of them overlap.
            f32::INFINITY
        } else {
            // Beyond all boxes, and finite, since an empty box ends at infinity.
            0.25 * f32::MAX
        }
    }

    /// The number of leaves.
    pub(crate) fn num_leaves(&self) -> usize {
        self.faces().len().div_ceil(WIDTH)
    }

    /// The places of the faces of a leaf.
    pub(crate) fn leaf_places(&self, leaf: usize) -> Range<u32> {
        let place = |place: usize| u32::try_from(place.min(self.faces().len())).expect("no more faces than ids");
        place(WIDTH * leaf)..place(WIDTH * (leaf + 1))
    }

    /// Goes on with a traversal of pairs of nodes, those on the stack, and appends each pair of faces below them whose
    /// boxes come within a [margin](Self::margin_f32) of each other once, except for those that share a vertex. Ends
    /// with `max_pairs` and a few more, or after as many visits. Faces are named by their places in the order of the
    /// tree.
    #[inline(always)]
    pub(crate) fn near_faces(
        &self,
        simd: impl InstructionSet,
        margin: f32,
        stack: &mut Vec<NodePair>,
        max_pairs: usize,
        found: &mut Vec<[u32; 2]>,
    ) {
        let mut num_visits = 0;
        while found.len() < max_pairs && num_visits < max_pairs {
            let Some(pair @ NodePair { level, nodes: [a, b] }) = stack.pop() else { break };
            num_visits += 1;
            if self.are_bodies(level, a, b) {
                continue;
            }
            let mut pairs = self.near_slots(simd, margin, pair);
            if a == b {
                pairs &= if level == 0 { ABOVE_DIAGONAL } else { ABOVE_DIAGONAL | DIAGONAL };
            }
            if level > 0 {
                push_children(pair, pairs, stack);
                continue;
            }
            pairs &= !self.adjacency.mask(a, b);
            while pairs != 0 {
                let (slot, other) = (pairs.trailing_zeros() / 8, pairs.trailing_zeros() % 8);
                pairs &= pairs - 1;
                found.push([8 * a + slot, 8 * b + other]);
            }
        }
    }

    /// Starts a traversal from the root: puts pairs of subtrees on the list that can be traversed independently, nodes
    /// of the topmost level with at least `min_nodes` whose boxes come within a [margin](Self::margin_f32).
    pub(crate) fn near_subtrees(&self, margin: f32, min_nodes: usize, pairs: &mut Vec<NodePair>) {
        pairs.clear();
        let end_level = (0..self.levels.len()).rev().find(|&level| self.levels[level].len() >= min_nodes).unwrap_or(0);
        let mut stack: Vec<NodePair> = self.root_pair().into_iter().collect();
        while let Some(pair @ NodePair { level, nodes: [a, b] }) = stack.pop() {
            if level <= end_level {
                pairs.push(pair);
            } else if !self.are_bodies(level, a, b) {
                let mut children = self.near_slots(Portable, margin, pair);
                if a == b {
                    children &= ABOVE_DIAGONAL | DIAGONAL;
                }
                push_children(pair, children, &mut stack);
            }
        }
    }

    /// Bit `8 i + k` for each pair of child `i` of the first node and child `k` of the second whose boxes come within
    /// a margin of each other.
    #[inline(always)]
    pub(crate) fn near_slots(&self, simd: impl InstructionSet, margin: f32, pair: NodePair) -> u64 {
        let NodePair { level, nodes: [a, b] } = pair;
        let boxes = &self.levels[level];
        let first = &boxes[a as usize];
        let inflated = if self.has_far { first.inflated_far(margin) } else { first.inflated(margin) };
        inflated.overlap_mask_x8(simd, &boxes[b as usize])
    }

    /// Calls `found` once for each pair of leaves, the first not after the second, that may be within `margin_m` metres
    /// of each other, except for those all of whose faces share one vertex. Ends early, and returns false, after
    /// `max_visits` pairs of nodes.
    #[inline(always)]
    pub(crate) fn leaves_within_margin(
        &self,
        simd: impl InstructionSet,
        margin_m: f64,
        stack: &mut Vec<NodePair>,
        max_visits: usize,
        mut found: impl FnMut([u32; 2]),
    ) -> bool {
        let Some(root_pair) = self.root_pair() else { return true };
        let margin = self.margin_f32(margin_m);
        stack.clear();
        stack.push(root_pair);
        let mut num_visits = 0;
        while let Some(pair @ NodePair { level, nodes: [a, b] }) = stack.pop() {
            num_visits += 1;
            if num_visits > max_visits {
                return false;
            }
            if self.have_common_hub(level, a, b) {
                continue;
            }
            if level == 0 {
                found([a, b]);
                continue;
            }
            let boxes = &self.levels[level];
            let mut pairs = boxes[a as usize].inflated(margin).overlap_mask_x8(simd, &boxes[b as usize]);
            if a == b {
                pairs &= ABOVE_DIAGONAL | DIAGONAL;
            }
            push_children(pair, pairs, stack);
        }
        true
    }

    /// Calls `found` with each pair of faces of two leaves, the first not after the second, that may be within
    /// `margin_m` metres of each other, except for those that share a vertex. Returns a lower bound of the distance of
    /// all other pairs, in metres.
    ///
    /// Boxes are made from the positions of the frame, since those of the tree may be of an earlier one.
    #[inline(always)]
    pub(crate) fn faces_within_margin(
        &self,
        simd: impl InstructionSet,
        frame: &Frame,
        [a, b]: [u32; 2],
        margin_m: f64,
        mut found: impl FnMut([u32; 2]),
    ) -> f64 {
        let origin: [f64; 3] = frame.position(self.corners[WIDTH * a as usize][0]).into();
        let first = self.leaf_boxes(frame, a, origin);
        let second = if a == b { first } else { self.leaf_boxes(frame, b, origin) };
        #[expect(clippy::cast_possible_truncation, reason = "what was lost is subtracted below")]
        let margin = margin_m as f32;
        let largest = max(first.union().max_abs(), second.union().max_abs()) + margin;
        let mut pairs = if largest.is_finite() {
            first.inflated(margin).overlap_mask_x8(simd, &second)
        } else {
            // Beyond the range of single precision anything may overlap, and empty slots seem to.
            self.occupied_mask(a, b)
        };
        if a == b {
            pairs &= ABOVE_DIAGONAL;
        }
        pairs &= !self.adjacency.mask(a, b);
        while pairs != 0 {
            let (slot, other) = (pairs.trailing_zeros() / 8, pairs.trailing_zeros() % 8);
            pairs &= pairs - 1;
            found([8 * a + slot, 8 * b + other]);
        }
        // Three roundings of half an ulp of the largest number there is; and what underflows.
        f64::from(margin) - f64::from(largest) * 4e-7 - 1e-37
    }

    /// The pairs of slots of two leaves that both hold a face.
    fn occupied_mask(&self, a: u32, b: u32) -> u64 {
        let count = |leaf: u32| (self.corners.len() - WIDTH * leaf as usize).min(WIDTH);
        (0..count(a)).fold(0, |pairs, slot| pairs | (0xff >> (WIDTH - count(b))) << (WIDTH * slot))
    }

    /// The boxes of a leaf's faces relative to a point, by a map that is monotone.
    #[inline(always)]
    fn leaf_boxes(&self, frame: &Frame, leaf: u32, origin: [f64; 3]) -> AabbX8 {
        let mut boxes = AabbX8::EMPTY;
        let first = WIDTH * leaf as usize;
        for (slot, corners) in self.corners[first..(first + WIDTH).min(self.corners.len())].iter().enumerate() {
            let point = |corner: VertexId| -> [f32; 3] {
                let position = frame.position(corner);
                #[expect(clippy::cast_possible_truncation, reason = "monotone, which is all that is needed")]
                let along = |axis: usize| (position[axis] - origin[axis]) as f32;
                [along(0), along(1), along(2)]
            };
            let (a, b, c) = (point(corners[0]), point(corners[1]), point(corners[2]));
            boxes.set(slot, Aabb::of_triangle([&a, &b, &c]));
        }
        boxes
    }
}

/// Puts pairs of children of two nodes on the stack, by their slots.
#[inline(always)]
fn push_children(NodePair { level, nodes: [a, b] }: NodePair, mut slots: u64, stack: &mut Vec<NodePair>) {
    while slots != 0 {
        let (slot, other) = (slots.trailing_zeros() / 8, slots.trailing_zeros() % 8);
        slots &= slots - 1;
        stack.push(NodePair { level: level - 1, nodes: [8 * a + slot, 8 * b + other] });
    }
}
