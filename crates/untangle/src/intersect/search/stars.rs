//! Cold search around vertices: faces that share a vertex, which always touch.

use std::ops::Range;

use super::share::Search;
use crate::{
    intersect::filter::injective_mask_x8,
    simd::{InstructionSet, Task},
};

/// The work of testing one batch of eight stars, or one star, in floating point.
pub(in crate::intersect) const STAR_TEST: usize = 16;

/// Vertex stars, by ranges of the batches of one-rings and of those in no batch.
pub(in crate::intersect) struct VertexStars {
    pub(in crate::intersect) batches: Range<usize>,
    pub(in crate::intersect) unbatched: Range<usize>,
}

impl Task for Search<'_, VertexStars> {
    /// Stars in single precision, then in double precision, then exact signs.
    #[inline(always)]
    fn run<S: InstructionSet>(mut self, simd: S) {
        let (one_rings, points) = (self.one_rings, self.bvh.points_f32());
        let VertexStars { batches, unbatched } = &self.kind;
        let (batches, unbatched) = (batches.clone(), &one_rings.unbatched()[unbatched.clone()]);
        while self.share.may_go_on() && !self.share.is_done {
            if self.share.star.is_loaded() {
                self.go_on_with_star();
                continue;
            }
            let at = self.share.next;
            self.share.next += 1;
            self.share.spend(STAR_TEST);
            if at < batches.len() {
                let rings = one_rings.batch(batches.start + at);
                let mut open = !injective_mask_x8(simd.f32x8(), points, &rings) & 0xff;
                if self.bvh.has_far() {
                    open |= self.bvh.far_lanes(rings.around.iter().chain([rings.centres]));
                }
                while open != 0 {
                    self.test_unless_injective(rings.numbers[open.trailing_zeros() as usize]);
                    open &= open - 1;
                }
            } else if let Some(&ring) = unbatched.get(at - batches.len()) {
                self.test_unless_injective(ring);
            } else {
                self.share.is_done = true;
            }
        }
    }
}

impl Search<'_, VertexStars> {
    #[inline(always)]
    fn test_unless_injective(&mut self, ring: u32) {
        let ring = ring as usize;
        self.share.spend(self.one_rings.get(ring).around.len());
        if !self.share.star_filter.is_injective(self.frame, self.one_rings.get(ring)) {
            self.test_star(ring);
        }
    }
}
