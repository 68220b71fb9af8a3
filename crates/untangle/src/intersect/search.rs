//! What the search does with one part of a frame: pairs of subtrees, rings, and what is left of them where proofs are kept.

mod kept;

use std::ops::Range;

use super::{
    boxes::WIDTH,
    broad::{FaceTree, NodePair},
    lanes::{FOUR, Lanes, Task},
    narrow::{Contact, Fan, contact, share_a_vertex},
    separate::{ALL_FOUR, FourTriangles, Triangle, are_eight_apart, put},
    umbrella::Umbrella,
    umbrellas::are_open,
};
use crate::{
    frame::Frame,
    mesh::{FaceId, Mesh},
};

pub(super) use kept::{AllLeaves, KeptPairs, KeptRings};

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
        let [a, b] = [self.tree.face(places[0]), self.tree.face(places[1])];
        if self.tree.misses_neighbours() && share_a_vertex(self.mesh, [a, b]) {
            return;
        }
        if let Some(contact) = contact(self.mesh, self.frame, [a, b]) {
            self.part.contacts.push((if a < b { [a, b] } else { [b, a] }, contact));
        }
    }

    /// Tests those of up to four pairs that are not marked in `apart`.
    #[inline(always)]
    fn test_rest(&mut self, four: &[[u32; 2]], apart: u32) {
        for (lane, &places) in four.iter().enumerate() {
            if apart >> lane & 1 == 0 {
                self.test(places);
            }
        }
    }

    /// Drops the pairs that single precision proves to be apart.
    #[inline(always)]
    fn keep_close<L: Lanes>(&self, lanes: L, pairs: &mut Vec<[u32; 2]>) {
        let mut corners = [[[0; WIDTH]; 3]; 2];
        let mut num_kept = 0;
        for first in (0..pairs.len()).step_by(WIDTH) {
            let num_pairs = WIDTH.min(pairs.len() - first);
            for lane in 0..num_pairs {
                for (triangle, place) in corners.iter_mut().zip(pairs[first + lane]) {
                    for (corner, vertex) in triangle.iter_mut().zip(self.tree.corners(place)) {
                        corner[lane] = vertex.0;
                    }
                }
            }
            // What lies in other lanes is that of earlier pairs.
            let unused = 0xff & (0xff << num_pairs);
            let mut close = !are_eight_apart(lanes.eight(), self.tree.mapped(), &corners, unused) & 0xff;
            while close != 0 {
                pairs[num_kept] = pairs[first + close.trailing_zeros() as usize];
                close &= close - 1;
                num_kept += 1;
            }
        }
        pairs.truncate(num_kept);
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
        let [a, b, c] = self.tree.corners(place);
        [self.frame.position(a).into(), self.frame.position(b).into(), self.frame.position(c).into()]
    }

    /// Tests the faces of a ring.
    #[inline(always)]
    fn test_ring_unless_open(&mut self, ring: u32) {
        let ring = ring as usize;
        if !self.part.umbrella.is_open(self.frame, self.tree.rings().get(ring)) {
            self.test_fan(ring);
        }
    }

    /// Tests the faces of a ring pair by pair.
    fn test_fan(&mut self, ring: usize) {
        let centre = self.tree.rings().get(ring).centre;
        let Part { fan, contacts, .. } = &mut *self.part;
        fan.contacts(self.mesh, self.frame, centre, &mut |faces, contact| contacts.push((faces, contact)));
    }
}

/// Pairs of subtrees: the first and every `step`th from there.
pub(super) struct SomeSubtrees<'a> {
    pub(super) all: &'a [NodePair],
    pub(super) first: usize,
    pub(super) step: usize,
}

impl Task for Search<'_, SomeSubtrees<'_>> {
    /// Tests the pairs of faces of pairs of subtrees.
    #[inline(always)]
    fn run<L: Lanes>(mut self, lanes: L) {
        let Part { stack, pairs, .. } = &mut *self.part;
        pairs.clear();
        let SomeSubtrees { all, first, step } = self.what;
        for &subtrees in all.iter().skip(first).step_by(step) {
            self.tree.search(lanes, subtrees, stack, |places| pairs.push(places));
        }
        let mut pairs = std::mem::take(&mut self.part.pairs);
        self.keep_close(lanes, &mut pairs);
        let mut triangles = <[FourTriangles; 2]>::default();
        // Not one by one as they are found: what is called from there would be compiled for the least of instruction sets.
        for four in pairs.chunks(FOUR) {
            let unused = self.load(four, &mut triangles);
            let apart = lanes.apart(&triangles, unused);
            self.test_rest(four, apart);
        }
        self.part.pairs = pairs;
    }
}

/// Rings: some of those in eights, and some of the others.
pub(super) struct SomeRings {
    pub(super) eights: Range<usize>,
    pub(super) others: Range<usize>,
}

impl Task for Search<'_, SomeRings> {
    /// Tests the pairs of faces round vertices, which always touch.
    #[inline(always)]
    fn run<L: Lanes>(mut self, lanes: L) {
        let tree = self.tree;
        let SomeRings { eights, others } = &self.what;
        let (eights, others) = (eights.clone(), &tree.rings().others()[others.clone()]);
        for rings in eights.map(|eight| tree.rings().eight(eight)) {
            let mut closed = !are_open(lanes.eight(), tree.mapped(), &rings) & 0xff;
            while closed != 0 {
                self.test_ring_unless_open(rings.numbers[closed.trailing_zeros() as usize]);
                closed &= closed - 1;
            }
        }
        for &ring in others {
            self.test_ring_unless_open(ring);
        }
    }
}
