//! Pairs within a margin of each other: for separation certificates that are to last, and for distances.

use rayon::prelude::*;

use super::{
    aabb::{Aabb, AabbX8, FAR_ROUNDING, WIDTH, max, min},
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

    /// A box that is larger by a [margin](Self::margin_f32) on every side, and by what rounds far coordinates.
    #[inline(always)]
    pub(crate) fn inflated(&self, aabb: &Aabb, margin: f32) -> Aabb {
        let rounding = if self.has_far { FAR_ROUNDING } else { 0.0 };
        let grown = |value: f32| margin + rounding * value.abs();
        Aabb {
            min: std::array::from_fn(|axis| max(aabb.min[axis] - grown(aabb.min[axis]), f32::MIN)),
            max: std::array::from_fn(|axis| min(aabb.max[axis] + grown(aabb.max[axis]), f32::MAX)),
        }
    }

    /// The boxes of the faces of a leaf.
    #[inline(always)]
    pub(crate) fn face_boxes(&self, leaf: u32) -> &AabbX8 {
        &self.levels[0][leaf as usize]
    }

    /// The leaves, each against itself.
    pub(crate) fn leaves_with_themselves(&self) -> impl IndexedParallelIterator<Item = NodePair> {
        let num_leaves = u32::try_from(self.levels[0].len()).expect("fewer leaves than faces");
        (0..num_leaves).into_par_iter().map(|leaf| NodePair { level: 0, nodes: [leaf, leaf] })
    }

    /// Goes down from the pairs of nodes on the stack, and calls `found` once for each pair of nodes of a level, the
    /// first not after the second, whose boxes come within a [margin](Self::margin_f32) of each other. Pairs whose
    /// faces share a vertex are among them, those of two bodies are not.
    #[inline(always)]
    pub(crate) fn near_nodes(
        &self,
        simd: impl InstructionSet,
        margin: f32,
        end_level: usize,
        stack: &mut Vec<NodePair>,
        mut found: impl FnMut(NodePair),
    ) {
        while let Some(pair @ NodePair { level, nodes: [a, b] }) = stack.pop() {
            if self.are_bodies(level, a, b) {
                continue;
            }
            if level <= end_level {
                found(pair);
                continue;
            }
            let mut pairs = self.near_slots(simd, margin, pair);
            if a == b {
                pairs &= ABOVE_DIAGONAL | DIAGONAL;
            }
            while pairs != 0 {
                let (slot, other) = (pairs.trailing_zeros() / 8, pairs.trailing_zeros() % 8);
                pairs &= pairs - 1;
                stack.push(NodePair { level: level - 1, nodes: [8 * a + slot, 8 * b + other] });
            }
        }
    }

    /// Starts a traversal from the root: puts pairs of subtrees on the list that can be traversed independently, the
    /// nodes of the topmost level with at least `min_nodes`.
    pub(crate) fn near_subtrees(&self, margin: f32, min_nodes: usize, pairs: &mut Vec<NodePair>) {
        pairs.clear();
        let end_level = (0..self.levels.len()).rev().find(|&level| self.levels[level].len() >= min_nodes).unwrap_or(0);
        let mut stack: Vec<NodePair> = self.root_pair().into_iter().collect();
        self.near_nodes(Portable, margin, end_level, &mut stack, |pair| pairs.push(pair));
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
        while let Some(NodePair { level, nodes: [a, b] }) = stack.pop() {
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
            while pairs != 0 {
                let (slot, other) = (pairs.trailing_zeros() / 8, pairs.trailing_zeros() % 8);
                pairs &= pairs - 1;
                stack.push(NodePair { level: level - 1, nodes: [8 * a + slot, 8 * b + other] });
            }
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
