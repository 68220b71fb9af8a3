//! What the search of every kind of share needs.

use crate::{
    frame::Frame,
    intersect::{
        bvh::{Bvh, NodePair},
        exact::{Contact, VertexStar, contact_of_disjoint},
        filter::{ALL_X4, OneRings, Triangle, TrianglesX4, VertexStarFilter, set_pair},
    },
    mesh::{FaceId, Mesh},
};

/// The work of one exact test: some hundred nanoseconds, up to a microsecond where signs are exactly zero.
pub(in crate::intersect) const EXACT_TEST: usize = 64;

/// The contacts of one share of the search, how far it has come, and its scratch memory.
#[derive(Debug, Default)]
pub(in crate::intersect) struct Share {
    /// The traversal, where it goes on.
    pub(in crate::intersect) stack: Vec<NodePair>,
    /// Pairs of faces by their places, as they pass from filter to filter.
    pub(in crate::intersect) candidates: Vec<[u32; 2]>,
    pub(in crate::intersect) star_filter: VertexStarFilter,
    pub(in crate::intersect) star: VertexStar,
    pub(in crate::intersect) contacts: Vec<([FaceId; 2], Contact)>,
    /// What the share consists of, up to here is begun.
    pub(in crate::intersect) next: usize,
    pub(in crate::intersect) is_done: bool,
    /// The first expiry in the group of certificates that is begun.
    pub(in crate::intersect) first_m: f64,
    /// Pairs of faces whose boxes overlap, in a cold search.
    pub(in crate::intersect) num_boxes: u64,
    /// Pairs of faces round vertices of many faces that came to exact signs.
    pub(in crate::intersect) num_around: u64,
    /// Work that is left in this round.
    work: usize,
}

impl Share {
    /// Starts over.
    pub(in crate::intersect) fn begin(&mut self) {
        self.stack.clear();
        self.candidates.clear();
        self.star.clear();
        self.contacts.clear();
        (self.next, self.is_done, self.num_boxes, self.num_around) = (0, false, 0, 0);
    }

    /// Gives it work for a round.
    pub(in crate::intersect) fn allow(&mut self, work: usize) {
        self.work = work;
    }

    /// Whether there is work left in this round.
    #[inline(always)]
    pub(in crate::intersect) fn may_go_on(&self) -> bool {
        self.work > 0
    }

    /// Counts work, in units of about ten nanoseconds: the test of a pair of boxes or of single precision.
    #[inline(always)]
    pub(in crate::intersect) fn spend(&mut self, work: usize) {
        self.work = self.work.saturating_sub(work);
    }
}

/// The search of one share, of the kind `K`.
pub(in crate::intersect) struct Search<'a, K> {
    pub(in crate::intersect) share: &'a mut Share,
    pub(in crate::intersect) bvh: &'a Bvh,
    pub(in crate::intersect) one_rings: &'a OneRings,
    pub(in crate::intersect) mesh: &'a Mesh,
    pub(in crate::intersect) frame: &'a Frame,
    pub(in crate::intersect) kind: K,
}

impl<K> Search<'_, K> {
    /// Tests a pair of faces exactly, unless they share a vertex or are faces of bodies.
    #[inline(always)]
    pub(in crate::intersect) fn test(&mut self, places: [u32; 2]) {
        if self.bvh.may_report_left_out() && self.bvh.is_left_out(places) {
            return;
        }
        let [a, b] = [self.bvh.face(places[0]), self.bvh.face(places[1])];
        self.share.spend(EXACT_TEST);
        if let Some(contact) = contact_of_disjoint(self.mesh, self.frame, [a, b]) {
            self.share.contacts.push((if a < b { [a, b] } else { [b, a] }, contact));
        }
    }

    /// Tests those of up to four pairs that are not marked in `separated`.
    #[inline(always)]
    pub(in crate::intersect) fn test_unseparated(&mut self, four: &[[u32; 2]], separated: u32) {
        for (lane, &places) in four.iter().enumerate() {
            if separated >> lane & 1 == 0 {
                self.test(places);
            }
        }
    }

    /// Loads up to four pairs and returns the mask of the lanes that are unused; those keep what earlier pairs left
    /// there.
    #[inline(always)]
    pub(in crate::intersect) fn load(&self, four: &[[u32; 2]], triangles: &mut [TrianglesX4; 2]) -> u32 {
        for (lane, &places) in four.iter().enumerate() {
            set_pair(triangles, lane, [self.triangle(places[0]), self.triangle(places[1])]);
        }
        ALL_X4 & (ALL_X4 << four.len())
    }

    #[inline(always)]
    fn triangle(&self, place: u32) -> Triangle {
        let [a, b, c] = self.bvh.corners(place);
        [self.frame.position(a).into(), self.frame.position(b).into(), self.frame.position(c).into()]
    }

    /// Tests the faces around a vertex exactly: all pairs, or those of a vertex of many faces as far as the work of
    /// this round reaches.
    pub(in crate::intersect) fn test_star(&mut self, ring: usize) {
        let centre = self.one_rings.get(ring).centre;
        self.share.star.load(self.mesh, self.frame, centre);
        self.go_on_with_star();
    }

    /// Goes on with a star that an earlier round did not finish.
    pub(in crate::intersect) fn go_on_with_star(&mut self) {
        let Share { star, contacts, num_around, work, .. } = &mut *self.share;
        let tested = star.test(self.mesh, *work, &mut |faces, contact| contacts.push((faces, contact)));
        *num_around += tested.num_around;
        self.share.spend(tested.work);
    }
}
