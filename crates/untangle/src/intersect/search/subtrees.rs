//! Cold search through pairs of subtrees: all faces that share no vertex.

use super::share::{Search, Share};
use crate::{
    intersect::{
        bvh::{NodePair, WIDTH},
        filter::{TrianglesX4, separated_mask_x4, separated_mask_x8},
    },
    simd::{F64_LANES, InstructionSet, Task},
};

/// Pairs of faces that are collected before they are tested: few enough to stay in the first cache, and to bound the
/// work between two looks at the clock; memory does not grow with the pairs whose boxes overlap.
const BATCH: usize = 256;

/// Every `step`th pair of subtrees, from `first` on.
pub(in crate::intersect) struct SubtreePairs<'a> {
    pub(in crate::intersect) all: &'a [NodePair],
    pub(in crate::intersect) first: usize,
    pub(in crate::intersect) step: usize,
}

impl Task for Search<'_, SubtreePairs<'_>> {
    /// Boxes, then triangles in single precision, then in double precision, then exact signs, batch by batch.
    #[inline(always)]
    fn run<S: InstructionSet>(mut self, simd: S) {
        let mut candidates = std::mem::take(&mut self.share.candidates);
        let mut triangles = <[TrianglesX4; 2]>::default();
        while self.share.may_go_on() && !self.share.is_done {
            candidates.clear();
            self.collect(simd, &mut candidates);
            self.share.num_boxes += candidates.len() as u64;
            self.share.spend(candidates.len());
            self.retain_unseparated(simd, &mut candidates);
            for four in candidates.chunks(F64_LANES) {
                let unused = self.load(four, &mut triangles);
                let separated = separated_mask_x4(simd, &triangles, unused);
                self.test_unseparated(four, separated);
            }
        }
        self.share.candidates = candidates;
    }
}

impl Search<'_, SubtreePairs<'_>> {
    /// Goes on with the traversal until there is a batch of pairs, or nothing left.
    #[inline(always)]
    fn collect<S: InstructionSet>(&mut self, simd: S, candidates: &mut Vec<[u32; 2]>) {
        let SubtreePairs { all, first, step } = self.kind;
        let Share { stack, next, is_done, .. } = &mut *self.share;
        let mut num_visits = 0;
        while candidates.len() < BATCH && num_visits < BATCH {
            if stack.is_empty() {
                let Some(&subtrees) = all.get(first + step * *next) else {
                    *is_done = true;
                    break;
                };
                *next += 1;
                stack.push(subtrees);
            }
            num_visits += self.bvh.overlapping_faces(simd, stack, [BATCH, BATCH - num_visits], candidates);
        }
        if self.bvh.may_report_left_out() {
            candidates.retain(|&places| !self.bvh.is_left_out(places));
        }
        self.share.spend(2 * num_visits);
    }

    /// Drops the pairs that single precision proves to be separated.
    #[inline(always)]
    fn retain_unseparated<S: InstructionSet>(&self, simd: S, pairs: &mut Vec<[u32; 2]>) {
        let mut corners = [[[0; WIDTH]; 3]; 2];
        let mut num_kept = 0;
        for first in (0..pairs.len()).step_by(WIDTH) {
            let num_pairs = WIDTH.min(pairs.len() - first);
            for lane in 0..num_pairs {
                for (triangle, place) in corners.iter_mut().zip(pairs[first + lane]) {
                    for (corner, vertex) in triangle.iter_mut().zip(self.bvh.corners(place)) {
                        corner[lane] = vertex.0;
                    }
                }
            }
            // The other lanes keep what earlier pairs left there.
            let unused = 0xff & (0xff << num_pairs);
            let mut open = !separated_mask_x8(simd.f32x8(), self.bvh.points_f32(), &corners, unused) & 0xff;
            if self.bvh.has_far() {
                open |= self.bvh.far_lanes(corners.iter().flatten()) & !unused & 0xff;
            }
            while open != 0 {
                pairs[num_kept] = pairs[first + open.trailing_zeros() as usize];
                open &= open - 1;
                num_kept += 1;
            }
        }
        pairs.truncate(num_kept);
    }
}
