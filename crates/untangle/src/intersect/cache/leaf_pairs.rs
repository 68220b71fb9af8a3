//! Search of the pairs of leaves whose certificates have expired.

use super::certificates::{Certificate, NEVER_TESTED, PAIRS_PER_GROUP, TOUCHING, expiry_m, pair_time_m};
use crate::{
    intersect::{
        bvh::{Bvh, NodePair},
        filter::{ALL_X4, TrianglesX4, max_gaps_m_x4, separated_mask_x4},
        search::Search,
    },
    simd::{F64_LANES, InstructionSet, Task},
};

/// The work of comparing the boxes of two leaves, which are made from the positions.
const LEAF_TEST: usize = 8;

/// Certificates of pairs of leaves, and the clocks by which they expire.
pub(in crate::intersect) struct ExpiredLeafPairs<'a> {
    pub(in crate::intersect) pairs: &'a mut [Certificate],
    /// For each group of them the first expiry.
    pub(in crate::intersect) groups_m: &'a mut [f64],
    pub(in crate::intersect) leaf_times_m: &'a [f64],
    /// No clock has advanced further.
    pub(in crate::intersect) latest_m: f64,
    pub(in crate::intersect) margin_m: f64,
}

impl Task for Search<'_, ExpiredLeafPairs<'_>> {
    /// Tests the pairs of leaves whose certificates have expired, and issues new ones.
    #[inline(always)]
    fn run<S: InstructionSet>(mut self, simd: S) {
        let mut near = std::mem::take(&mut self.share.candidates);
        while self.share.may_go_on() && !self.share.is_done {
            let group = self.share.next;
            if group == self.kind.groups_m.len() {
                self.share.is_done = true;
                break;
            }
            self.share.next += 1;
            self.share.spend(1);
            if 2.0 * self.kind.latest_m < self.kind.groups_m[group] {
                continue;
            }
            let mut first = f64::INFINITY;
            let start = group * PAIRS_PER_GROUP;
            for index in start..(start + PAIRS_PER_GROUP).min(self.kind.pairs.len()) {
                let Certificate { leaves, mut expires_m } = self.kind.pairs[index];
                let now_m = pair_time_m(self.kind.leaf_times_m, leaves);
                if now_m >= expires_m {
                    self.share.spend(LEAF_TEST);
                    // Leaves that touch mostly go on to touch: for them no distance is computed until they are
                    // separated.
                    let touched = expires_m.total_cmp(&TOUCHING).is_eq();
                    if !(touched && self.still_touch(simd, leaves, &mut near)) {
                        expires_m = expiry_m(now_m, self.distance_m(simd, leaves, &mut near));
                        self.kind.pairs[index].expires_m = expires_m;
                    }
                }
                first = if expires_m < first { expires_m } else { first };
            }
            self.kind.groups_m[group] = first;
        }
        self.share.candidates = near;
    }
}

impl Search<'_, ExpiredLeafPairs<'_>> {
    /// Tests the faces of two leaves, and says whether some are not separated; if none, there is no contact.
    #[inline(always)]
    fn still_touch<S: InstructionSet>(&mut self, simd: S, leaves: [u32; 2], near: &mut Vec<[u32; 2]>) -> bool {
        near.clear();
        self.bvh.faces_within_margin(simd, self.frame, leaves, 0.0, |places| near.push(places));
        let mut triangles = <[TrianglesX4; 2]>::default();
        let mut touch = false;
        self.share.spend(near.len());
        for four in near.chunks(F64_LANES) {
            let unused = self.load(four, &mut triangles);
            let separated = separated_mask_x4(simd, &triangles, unused);
            touch |= separated != ALL_X4;
            self.test_unseparated(four, separated);
        }
        touch
    }

    /// Tests the faces of two leaves; a lower bound of their distance in metres, zero where nothing is known.
    #[inline(always)]
    fn distance_m<S: InstructionSet>(&mut self, simd: S, leaves: [u32; 2], near: &mut Vec<[u32; 2]>) -> f64 {
        let margin_m = self.kind.margin_m;
        near.clear();
        let others_m = self.bvh.faces_within_margin(simd, self.frame, leaves, margin_m, |places| near.push(places));
        let mut triangles = <[TrianglesX4; 2]>::default();
        let mut nearest_m = f64::INFINITY;
        self.share.spend(near.len());
        for four in near.chunks(F64_LANES) {
            let unused = self.load(four, &mut triangles);
            let gaps_m = max_gaps_m_x4(simd, &triangles, margin_m, unused);
            for (&places, gap_m) in four.iter().zip(gaps_m) {
                if gap_m <= 0.0 {
                    self.test(places);
                }
                nearest_m = nearest_m.min(gap_m);
            }
        }
        // Without a bound for the other faces, which may be NaN, there is none for the leaves.
        if others_m > 0.0 { nearest_m.min(others_m) } else { 0.0 }
    }
}

/// Collects the pairs of leaves within the margin, each with a certificate that no frame has tested yet. Without all of
/// them, and `is_complete` false, where there are more than `max_pairs`.
pub(in crate::intersect) struct CollectLeafPairs<'a> {
    pub(in crate::intersect) bvh: &'a Bvh,
    pub(in crate::intersect) margin_m: f64,
    pub(in crate::intersect) max_pairs: usize,
    pub(in crate::intersect) stack: &'a mut Vec<NodePair>,
    pub(in crate::intersect) pairs: &'a mut Vec<Certificate>,
    pub(in crate::intersect) is_complete: &'a mut bool,
}

/// Pairs of nodes that are visited at most for each certificate.
const VISITS_PER_PAIR: usize = 4;

impl Task for CollectLeafPairs<'_> {
    #[inline(always)]
    fn run<S: InstructionSet>(self, simd: S) {
        let Self { bvh, margin_m, max_pairs, stack, pairs, is_complete } = self;
        let max_visits = max_pairs.saturating_mul(VISITS_PER_PAIR);
        let all = bvh.leaves_within_margin(simd, margin_m, stack, max_visits, |leaves| {
            if pairs.len() <= max_pairs {
                pairs.push(Certificate { leaves, expires_m: NEVER_TESTED });
            }
        });
        *is_complete = all && pairs.len() <= max_pairs;
    }
}
