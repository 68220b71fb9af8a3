//! What the search of every kind of share needs.

use crate::{
    frame::Frame,
    intersect::{
        bvh::{Bvh, NodePair},
        exact::{Contact, VertexStar, contact_of_disjoint, share_a_vertex},
        filter::{ALL_X4, OneRings, Triangle, TrianglesX4, VertexStarFilter, set_pair},
    },
    mesh::{FaceId, Mesh},
};

/// The contacts of one share of the search, and its scratch memory.
#[derive(Debug, Default)]
pub(in crate::intersect) struct Share {
    pub(in crate::intersect) stack: Vec<NodePair>,
    /// Pairs of faces by their places, as they pass from filter to filter.
    pub(in crate::intersect) candidates: Vec<[u32; 2]>,
    pub(in crate::intersect) star_filter: VertexStarFilter,
    star: VertexStar,
    pub(in crate::intersect) contacts: Vec<([FaceId; 2], Contact)>,
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
    /// Tests a pair of faces exactly, unless they share a vertex.
    #[inline(always)]
    pub(in crate::intersect) fn test(&mut self, places: [u32; 2]) {
        let [a, b] = [self.bvh.face(places[0]), self.bvh.face(places[1])];
        if self.bvh.may_report_adjacent() && share_a_vertex(self.mesh, [a, b]) {
            return;
        }
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

    /// Tests the faces around a vertex exactly, pair by pair.
    pub(in crate::intersect) fn test_star(&mut self, ring: usize) {
        let centre = self.one_rings.get(ring).centre;
        let Share { star, contacts, .. } = &mut *self.share;
        star.contacts(self.mesh, self.frame, centre, &mut |faces, contact| contacts.push((faces, contact)));
    }
}
