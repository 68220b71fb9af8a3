//! Search of the vertex stars whose certificates have expired.

use super::certificates::{STARS_PER_GROUP, expiry_m};
use crate::{
    intersect::search::Search,
    simd::{InstructionSet, Task},
};

/// Certificates of some vertex stars, and the clocks by which they expire.
pub(in crate::intersect) struct ExpiredStars<'a> {
    /// The number of the first star.
    pub(in crate::intersect) start: usize,
    pub(in crate::intersect) stars_m: &'a mut [f64],
    /// For each group of them the first expiry.
    pub(in crate::intersect) groups_m: &'a mut [f64],
    /// For each group its clock.
    pub(in crate::intersect) times_m: &'a [f64],
}

impl Task for Search<'_, ExpiredStars<'_>> {
    /// Tests the stars whose certificates have expired, and issues new ones.
    #[inline(always)]
    fn run<S: InstructionSet>(mut self, _: S) {
        for group in 0..self.kind.groups_m.len() {
            let now_m = self.kind.times_m[group];
            if now_m < self.kind.groups_m[group] {
                continue;
            }
            let mut first = f64::INFINITY;
            let start = group * STARS_PER_GROUP;
            for index in start..(start + STARS_PER_GROUP).min(self.kind.stars_m.len()) {
                let mut expires_m = self.kind.stars_m[index];
                if now_m >= expires_m {
                    expires_m = expiry_m(now_m, self.clearance_m(self.kind.start + index));
                    self.kind.stars_m[index] = expires_m;
                }
                first = if expires_m < first { expires_m } else { first };
            }
            self.kind.groups_m[group] = first;
        }
    }
}

impl Search<'_, ExpiredStars<'_>> {
    /// Tests the faces of a star; how far its vertices may move without a contact, in metres.
    #[inline(always)]
    fn clearance_m(&mut self, ring: usize) -> f64 {
        let clearance_m = self.share.star_filter.clearance_m(self.frame, self.one_rings.get(ring));
        if clearance_m <= 0.0 {
            self.test_star(ring);
        }
        clearance_m
    }
}
