//! Cold search through pairs of subtrees: all faces that share no vertex.

use super::share::{Search, Share};
use crate::{
    intersect::{
        bvh::{NodePair, WIDTH},
        filter::{TrianglesX4, separated_mask_x4, separated_mask_x8},
    },
    simd::{F64_LANES, InstructionSet, Task},
};

/// Every `step`th pair of subtrees, from `first` on.
pub(in crate::intersect) struct SubtreePairs<'a> {
    pub(in crate::intersect) all: &'a [NodePair],
    pub(in crate::intersect) first: usize,
    pub(in crate::intersect) step: usize,
}

impl Task for Search<'_, SubtreePairs<'_>> {
    /// Boxes, then triangles in single precision, then in double precision, then exact signs.
    #[inline(always)]
    fn run<S: InstructionSet>(mut self, simd: S) {
        let Share { stack, candidates, .. } = &mut *self.share;
        candidates.clear();
        let SubtreePairs { all, first, step } = self.kind;
        for &subtrees in all.iter().skip(first).step_by(step) {
            self.bvh.overlapping_faces(simd, subtrees, stack, |places| candidates.push(places));
        }
        let mut candidates = std::mem::take(&mut self.share.candidates);
        self.retain_unseparated(simd, &mut candidates);
        let mut triangles = <[TrianglesX4; 2]>::default();
        // Not at once when a pair is found: what the closure above calls would be compiled for the baseline instruction
        // set.
        for four in candidates.chunks(F64_LANES) {
            let unused = self.load(four, &mut triangles);
            let separated = separated_mask_x4(simd, &triangles, unused);
            self.test_unseparated(four, separated);
        }
        self.share.candidates = candidates;
    }
}

impl Search<'_, SubtreePairs<'_>> {
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
            while open != 0 {
                pairs[num_kept] = pairs[first + open.trailing_zeros() as usize];
                open &= open - 1;
                num_kept += 1;
            }
        }
        pairs.truncate(num_kept);
    }
}
