//! Search of the vertex stars whose certificates have expired.

use super::certificates::{STARS_PER_GROUP, expiry_m};
use crate::{
    intersect::{
        bvh::MAX_ADJACENT_FACES,
        search::{STAR_TEST, Search},
    },
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
        while self.share.may_go_on() && !self.share.is_done {
            if self.share.star.is_loaded() {
                self.go_on_with_star();
            } else if self.share.next < self.kind.stars_m.len() {
                self.test_next();
            } else {
                self.share.is_done = true;
            }
        }
    }
}

impl Search<'_, ExpiredStars<'_>> {
    /// Tests the next star whose certificate has expired, or passes over a group in which none has.
    #[inline(always)]
    fn test_next(&mut self) {
        let index = self.share.next;
        let group = index / STARS_PER_GROUP;
        let now_m = self.kind.times_m[group];
        self.share.spend(1);
        if index.is_multiple_of(STARS_PER_GROUP) {
            if now_m < self.kind.groups_m[group] {
                self.share.next += STARS_PER_GROUP;
                return;
            }
            self.share.first_m = f64::INFINITY;
        }
        let mut expires_m = self.kind.stars_m[index];
        if now_m >= expires_m {
            expires_m = expiry_m(now_m, self.clearance_m(self.kind.start + index));
            self.kind.stars_m[index] = expires_m;
        }
        self.share.first_m = if expires_m < self.share.first_m { expires_m } else { self.share.first_m };
        self.share.next += 1;
        if self.share.next.is_multiple_of(STARS_PER_GROUP) || self.share.next == self.kind.stars_m.len() {
            // Not before: a search that ends within a group leaves it expired.
            self.kind.groups_m[group] = self.share.first_m;
        }
    }

    /// Tests the faces of a star; how far its vertices may move without a contact, in metres.
    #[inline(always)]
    fn clearance_m(&mut self, ring: usize) -> f64 {
        let one_ring = self.one_rings.get(ring);
        self.share.spend(STAR_TEST + one_ring.around.len());
        if self.mesh.vertex_faces(one_ring.centre).len() > MAX_ADJACENT_FACES {
            // As in a cold search, and without a certificate, so that counts of its pairs don't depend on the cache.
            if !self.share.star_filter.is_injective(self.frame, one_ring) {
                self.test_star(ring);
            }
            return 0.0;
        }
        let clearance_m = self.share.star_filter.clearance_m(self.frame, one_ring);
        if clearance_m <= 0.0 {
            self.test_star(ring);
        }
        clearance_m
    }
}
