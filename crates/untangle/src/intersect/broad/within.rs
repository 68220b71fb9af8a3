//! Pairs of faces within a margin of each other, for proofs that are to last.

use super::{ABOVE_DIAGONAL, DIAGONAL, FaceTree, NodePair};
use crate::{
    frame::Frame,
    intersect::{
        boxes::{Boxes, EMPTY, Hull, WIDTH, higher, lower},
        lanes::Lanes,
    },
    mesh::VertexId,
};

impl FaceTree {
    /// Calls `found` once for each pair of leaves, the first not after the second, that may be within `margin_m` metres of each other.
    #[inline(always)]
    pub(crate) fn search_leaves(
        &self,
        lanes: impl Lanes,
        margin_m: f64,
        stack: &mut Vec<NodePair>,
        mut found: impl FnMut([u32; 2]),
    ) {
        let Some(top) = self.levels.len().checked_sub(1).filter(|_| !self.order.is_empty()) else { return };
        // Mapped coordinates are at most one half and rounded by 2^-25 of it at most, and so are the sums below.
        #[expect(clippy::cast_possible_truncation, reason = "more than the rounding is added")]
        let margin = (margin_m * self.scale * (1.0 + 1e-6) + 1e-6) as f32;
        stack.clear();
        stack.push(NodePair { level: top, nodes: [0, 0] });
        while let Some(NodePair { level, nodes: [a, b] }) = stack.pop() {
            if level == 0 {
                found([a, b]);
                continue;
            }
            let boxes = &self.levels[level];
            let mut pairs = lanes.overlapping_pairs(&boxes[a as usize].inflated(margin), &boxes[b as usize]);
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

    /// Calls `found` with the places of each pair of faces of two leaves, the first not after the second, that may be within `margin_m` metres of
    /// each other, but for those that share a vertex. Reads positions, not the boxes of the tree. Returns how far all others are apart at
    /// least, in metres.
    #[inline(always)]
    pub(crate) fn search_leaf(
        &self,
        lanes: impl Lanes,
        frame: &Frame,
        [a, b]: [u32; 2],
        margin_m: f64,
        mut found: impl FnMut([u32; 2]),
    ) -> f64 {
        let origin: [f64; 3] = frame.position(self.corners[WIDTH * a as usize][0]).into();
        let first = self.boxes_round(frame, a, origin);
        let second = if a == b { first } else { self.boxes_round(frame, b, origin) };
        #[expect(clippy::cast_possible_truncation, reason = "what was lost is subtracted below")]
        let margin = margin_m as f32;
        let largest = higher(largest(first.hull()), largest(second.hull())) + margin;
        let mut pairs = if largest.is_finite() {
            lanes.overlapping_pairs(&first.inflated(margin), &second)
        } else {
            // Beyond single precision everything may overlap, and unused places seem to.
            self.present_pairs(a, b)
        };
        if a == b {
            pairs &= ABOVE_DIAGONAL;
        }
        pairs &= !self.neighbours.between(a, b);
        while pairs != 0 {
            let (slot, other) = (pairs.trailing_zeros() / 8, pairs.trailing_zeros() % 8);
            pairs &= pairs - 1;
            found([8 * a + slot, 8 * b + other]);
        }
        // Three roundings of half an ulp of the largest number there is; and what underflows.
        f64::from(margin) - f64::from(largest) * 4e-7 - 1e-37
    }

    /// The pairs of places of two leaves that both hold a face.
    fn present_pairs(&self, a: u32, b: u32) -> u64 {
        let count = |leaf: u32| (self.corners.len() - WIDTH * leaf as usize).min(WIDTH);
        (0..count(a)).fold(0, |pairs, slot| pairs | (0xff >> (WIDTH - count(b))) << (WIDTH * slot))
    }

    /// The boxes of a leaf's faces relative to a point, by a map that is monotone.
    #[inline(always)]
    fn boxes_round(&self, frame: &Frame, leaf: u32, origin: [f64; 3]) -> Boxes {
        let mut boxes = EMPTY;
        let first = WIDTH * leaf as usize;
        for (slot, corners) in self.corners[first..(first + WIDTH).min(self.corners.len())].iter().enumerate() {
            let point = |corner: VertexId| -> [f32; 3] {
                let position = frame.position(corner);
                #[expect(clippy::cast_possible_truncation, reason = "monotone, which is all that is needed")]
                let along = |axis: usize| (position[axis] - origin[axis]) as f32;
                [along(0), along(1), along(2)]
            };
            let (a, b, c) = (point(corners[0]), point(corners[1]), point(corners[2]));
            let low = std::array::from_fn(|axis| lower(lower(a[axis], b[axis]), c[axis]));
            let high = std::array::from_fn(|axis| higher(higher(a[axis], b[axis]), c[axis]));
            boxes.set(slot, (low, high));
        }
        boxes
    }
}

/// The largest magnitude of a coordinate.
#[inline(always)]
fn largest((low, high): Hull) -> f32 {
    low.into_iter().chain(high).fold(0.0, |largest, coordinate| higher(largest, coordinate.abs()))
}
