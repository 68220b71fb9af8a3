//! Cold search around vertices: faces that share a vertex, which always touch.

use std::ops::Range;

use super::share::Search;
use crate::{
    intersect::filter::injective_mask_x8,
    simd::{InstructionSet, Task},
};

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
        for rings in batches.map(|batch| one_rings.batch(batch)) {
            let mut open = !injective_mask_x8(simd.f32x8(), points, &rings) & 0xff;
            while open != 0 {
                self.test_unless_injective(rings.numbers[open.trailing_zeros() as usize]);
                open &= open - 1;
            }
        }
        for &ring in unbatched {
            self.test_unless_injective(ring);
        }
    }
}

impl Search<'_, VertexStars> {
    #[inline(always)]
    fn test_unless_injective(&mut self, ring: u32) {
        let ring = ring as usize;
        if !self.share.star_filter.is_injective(self.frame, self.one_rings.get(ring)) {
            self.test_star(ring);
        }
    }
}
