//! What the search does with one part of a frame: pairs of subtrees, rings, and what is left of them where proofs are kept.

use std::ops::Range;

use super::{
    broad::{FaceTree, NodePair},
    coherence::{Coherence, LeafPair, RINGS_OF_GROUP, until},
    lanes::{FOUR, Lanes, Task},
    narrow::{Contact, Fan, contact, share_a_vertex},
    separate::{ALL_FOUR, FourTriangles, Triangle, put},
    umbrella::Umbrella,
};
use crate::{
    frame::Frame,
    mesh::{FaceId, Mesh},
};

/// What one part of the search found, with the memory that it needs.
#[derive(Debug, Default)]
pub(super) struct Part {
    stack: Vec<NodePair>,
    /// Places of faces whose boxes overlap.
    pairs: Vec<[u32; 2]>,
    umbrella: Umbrella,
    fan: Fan,
    pub(super) contacts: Vec<([FaceId; 2], Contact)>,
}

/// One part of the search: two subtrees, or a range of rings.
pub(super) struct Search<'a, T> {
    pub(super) part: &'a mut Part,
    pub(super) tree: &'a FaceTree,
    pub(super) mesh: &'a Mesh,
    pub(super) frame: &'a Frame,
    pub(super) what: T,
}

impl<T> Search<'_, T> {
    /// Tests a pair of faces exactly, unless they share a vertex.
    #[inline(always)]
    fn test(&mut self, places: [u32; 2]) {
        let [a, b] = places.map(|place| self.tree.face(place));
        if self.tree.misses_neighbours() && share_a_vertex(self.mesh, [a, b]) {
            return;
        }
        if let Some(contact) = contact(self.mesh, self.frame, [a, b]) {
            self.part.contacts.push((if a < b { [a, b] } else { [b, a] }, contact));
        }
    }

    /// Puts up to four pairs side by side, and says which lanes are left: what lies there is that of earlier pairs.
    #[inline(always)]
    fn load(&self, four: &[[u32; 2]], triangles: &mut [FourTriangles; 2]) -> u32 {
        for (lane, &places) in four.iter().enumerate() {
            put(triangles, lane, [self.triangle(places[0]), self.triangle(places[1])]);
        }
        ALL_FOUR & (ALL_FOUR << four.len())
    }

    #[inline(always)]
    fn triangle(&self, place: u32) -> Triangle {
        self.tree.corners(place).map(|corner| self.frame.position(corner).into())
    }

    /// Tests the faces of a ring; how far it may move with nothing found, in metres.
    #[inline(always)]
    fn test_ring(&mut self, ring: usize) -> f64 {
        let room = self.part.umbrella.room_m(self.frame, self.tree.rings().get(ring));
        if room <= 0.0 {
            self.test_fan(ring);
        }
        room
    }

    /// Tests the faces of a ring pair by pair.
    fn test_fan(&mut self, ring: usize) {
        let centre = self.tree.rings().get(ring).centre;
        let Part { fan, contacts, .. } = &mut *self.part;
        fan.contacts(self.mesh, self.frame, centre, &mut |faces, contact| contacts.push((faces, contact)));
    }
}

impl Task for Search<'_, NodePair> {
    /// Tests the pairs of two subtrees.
    #[inline(always)]
    fn run<L: Lanes>(mut self, lanes: L) {
        let Part { stack, pairs, .. } = &mut *self.part;
        pairs.clear();
        self.tree.search(lanes, self.what, stack, |places| pairs.push(places));
        let pairs = std::mem::take(&mut self.part.pairs);
        let mut triangles = <[FourTriangles; 2]>::default();
        // Not one by one as they are found: what is called from there would be compiled for the least of instruction sets.
        for four in pairs.chunks(FOUR) {
            let unused = self.load(four, &mut triangles);
            let apart = lanes.apart(&triangles, unused);
            for (lane, &places) in four.iter().enumerate() {
                if apart >> lane & 1 == 0 {
                    self.test(places);
                }
            }
        }
        self.part.pairs = pairs;
    }
}

impl Task for Search<'_, Range<usize>> {
    /// Tests the pairs of faces round vertices, which always touch.
    #[inline(always)]
    fn run<L: Lanes>(mut self, _: L) {
        for ring in self.what.clone() {
            let is_open = self.part.umbrella.is_open(self.frame, self.tree.rings().get(ring));
            if !is_open {
                self.test_fan(ring);
            }
        }
    }
}

/// Proofs about pairs of leaves, and the clocks by which they run out.
pub(super) struct KeptPairs<'a> {
    pub(super) pairs: &'a mut [LeafPair],
    pub(super) clocks: &'a [f64],
    pub(super) margin_m: f64,
}

impl Task for Search<'_, KeptPairs<'_>> {
    /// Tests the pairs of leaves whose time has come.
    #[inline(always)]
    fn run<L: Lanes>(mut self, lanes: L) {
        let (tree, frame, margin_m, clocks) = (self.tree, self.frame, self.what.margin_m, self.what.clocks);
        let mut near = std::mem::take(&mut self.part.pairs);
        let mut triangles = <[FourTriangles; 2]>::default();
        for index in 0..self.what.pairs.len() {
            let LeafPair { leaves, until: end } = self.what.pairs[index];
            let now = Coherence::time_of(clocks, leaves);
            if now < end {
                continue;
            }
            near.clear();
            let others = tree.search_leaf(lanes, frame, leaves, margin_m, |places| near.push(places));
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
            let span = if others > 0.0 { nearest.min(others) } else { 0.0 };
            self.what.pairs[index].until = until(now, span);
        }
        self.part.pairs = near;
    }
}

/// Proofs about rings, and the clocks by which they run out.
pub(super) struct KeptRings<'a> {
    /// The first of them.
    pub(super) first: usize,
    pub(super) rings_until: &'a mut [f64],
    pub(super) clocks: &'a [f64],
}

impl Task for Search<'_, KeptRings<'_>> {
    /// Tests the rings whose time has come.
    #[inline(always)]
    fn run<L: Lanes>(mut self, _: L) {
        for index in 0..self.what.rings_until.len() {
            let ring = self.what.first + index;
            let now = self.what.clocks[ring / RINGS_OF_GROUP];
            if now >= self.what.rings_until[index] {
                let room = self.test_ring(ring);
                self.what.rings_until[index] = until(now, room);
            }
        }
    }
}

/// All pairs of leaves that are to be kept an eye on.
pub(super) struct AllLeaves<'a> {
    pub(super) tree: &'a FaceTree,
    pub(super) margin_m: f64,
    pub(super) stack: &'a mut Vec<NodePair>,
    pub(super) pairs: &'a mut Vec<LeafPair>,
}

impl Task for AllLeaves<'_> {
    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let Self { tree, margin_m, stack, pairs } = self;
        tree.search_leaves(lanes, margin_m, stack, |leaves| pairs.push(LeafPair { leaves, until: 0.0 }));
    }
}
