//! What is left to search where proofs of earlier frames are kept.

use super::Search;
use crate::intersect::{
    broad::{FaceTree, NodePair},
    coherence::{Coherence, LeafPair, NEVER_SEEN, PAIRS_OF_GROUP, RINGS_OF_GROUP, TOUCHING, until},
    lanes::{FOUR, Lanes, Task},
    separate::{ALL_FOUR, FourTriangles},
};

/// Proofs about pairs of leaves, and the clocks by which they run out.
pub(in crate::intersect) struct KeptPairs<'a> {
    pub(in crate::intersect) pairs: &'a mut [LeafPair],
    /// For each group of them when the first proof runs out.
    pub(in crate::intersect) first: &'a mut [f64],
    pub(in crate::intersect) clocks: &'a [f64],
    /// No clock has gone further.
    pub(in crate::intersect) latest: f64,
    pub(in crate::intersect) margin_m: f64,
}

impl Task for Search<'_, KeptPairs<'_>> {
    /// Tests the pairs of leaves whose time has come.
    #[inline(always)]
    fn run<L: Lanes>(mut self, lanes: L) {
        let mut near = std::mem::take(&mut self.part.pairs);
        for group in 0..self.what.first.len() {
            if 2.0 * self.what.latest < self.what.first[group] {
                continue;
            }
            let mut first = f64::INFINITY;
            let start = group * PAIRS_OF_GROUP;
            for index in start..(start + PAIRS_OF_GROUP).min(self.what.pairs.len()) {
                let LeafPair { leaves, until: mut end } = self.what.pairs[index];
                let now = Coherence::time_of(self.what.clocks, leaves);
                if now >= end {
                    // Where faces meet they mostly go on to meet, and then no distance is worth anything.
                    let touched = end.total_cmp(&TOUCHING).is_eq();
                    if !(touched && self.still_touch(lanes, leaves, &mut near)) {
                        end = until(now, self.distance_m(lanes, leaves, &mut near));
                        self.what.pairs[index].until = end;
                    }
                }
                first = if end < first { end } else { first };
            }
            self.what.first[group] = first;
        }
        self.part.pairs = near;
    }
}

impl Search<'_, KeptPairs<'_>> {
    /// Tests the faces of two leaves, and says whether some are not proven to be apart; if none, nothing was found.
    #[inline(always)]
    fn still_touch<L: Lanes>(&mut self, lanes: L, leaves: [u32; 2], near: &mut Vec<[u32; 2]>) -> bool {
        near.clear();
        self.tree.search_leaf(lanes, self.frame, leaves, 0.0, |places| near.push(places));
        let mut triangles = <[FourTriangles; 2]>::default();
        let mut touch = false;
        for four in near.chunks(FOUR) {
            let unused = self.load(four, &mut triangles);
            let apart = lanes.apart(&triangles, unused);
            touch |= apart != ALL_FOUR;
            self.test_rest(four, apart);
        }
        touch
    }

    /// Tests the faces of two leaves and bounds their distance from below, in metres; zero where nothing is known.
    #[inline(always)]
    fn distance_m<L: Lanes>(&mut self, lanes: L, leaves: [u32; 2], near: &mut Vec<[u32; 2]>) -> f64 {
        let margin_m = self.what.margin_m;
        near.clear();
        let others = self.tree.search_leaf(lanes, self.frame, leaves, margin_m, |places| near.push(places));
        let mut triangles = <[FourTriangles; 2]>::default();
        let mut nearest = f64::INFINITY;
        for four in near.chunks(FOUR) {
            let unused = self.load(four, &mut triangles);
            let distances = lanes.distances_m(&triangles, margin_m, unused);
            for (&places, distance) in four.iter().zip(distances) {
                if distance <= 0.0 {
                    self.test(places);
                }
                nearest = nearest.min(distance);
            }
        }
        // Where nothing is known of the others, not even a number.
        if others > 0.0 { nearest.min(others) } else { 0.0 }
    }
}

/// Proofs about rings, and the clocks by which they run out.
pub(in crate::intersect) struct KeptRings<'a> {
    /// The first of them.
    pub(in crate::intersect) start: usize,
    pub(in crate::intersect) rings_until: &'a mut [f64],
    /// For each group of them when the first proof runs out, and its clock.
    pub(in crate::intersect) first: &'a mut [f64],
    pub(in crate::intersect) clocks: &'a [f64],
}

impl Task for Search<'_, KeptRings<'_>> {
    /// Tests the rings whose time has come.
    #[inline(always)]
    fn run<L: Lanes>(mut self, _: L) {
        for group in 0..self.what.first.len() {
            let now = self.what.clocks[group];
            if now < self.what.first[group] {
                continue;
            }
            let mut first = f64::INFINITY;
            let start = group * RINGS_OF_GROUP;
            for index in start..(start + RINGS_OF_GROUP).min(self.what.rings_until.len()) {
                let mut end = self.what.rings_until[index];
                if now >= end {
                    end = until(now, self.test_ring(self.what.start + index));
                    self.what.rings_until[index] = end;
                }
                first = if end < first { end } else { first };
            }
            self.what.first[group] = first;
        }
    }
}

impl Search<'_, KeptRings<'_>> {
    /// Tests the faces of a ring; how far it may move with nothing found, in metres.
    #[inline(always)]
    fn test_ring(&mut self, ring: usize) -> f64 {
        let room = self.part.umbrella.room_m(self.frame, self.tree.rings().get(ring));
        if room <= 0.0 {
            self.test_fan(ring);
        }
        room
    }
}

/// All pairs of leaves that are to be kept an eye on.
pub(in crate::intersect) struct AllLeaves<'a> {
    pub(in crate::intersect) tree: &'a FaceTree,
    pub(in crate::intersect) margin_m: f64,
    pub(in crate::intersect) stack: &'a mut Vec<NodePair>,
    pub(in crate::intersect) pairs: &'a mut Vec<LeafPair>,
}

impl Task for AllLeaves<'_> {
    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let Self { tree, margin_m, stack, pairs } = self;
        tree.search_leaves(lanes, margin_m, stack, |leaves| pairs.push(LeafPair { leaves, until: NEVER_SEEN }));
    }
}
