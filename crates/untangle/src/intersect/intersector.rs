//! From a frame to its sorted intersections.

use rayon::prelude::*;

use super::{
    assemble::Assembler,
    bvh::{Bvh, NodePair, WIDTH},
    cache::{
        CertificateCache, CollectLeafPairs, ExpiredLeafPairs, ExpiredStars, Mode, PAIRS_PER_GROUP, STARS_PER_GROUP,
    },
    exact::Contact,
    filter::OneRings,
    intersections::Intersections,
    limits::{Rounds, SearchEnd, SearchLimits},
    search::{Search, Share, SubtreePairs, VertexStars},
};
use crate::{
    frame::Frame,
    mesh::{FaceId, Mesh},
    simd::dispatch,
    stage::StageObserver,
};

/// Subtrees into which a cold search is split, at least, where the tree has as many.
const MIN_SUBTREES: usize = 16;

/// Shares of a cold search through pairs of subtrees. Neighbours in their list go to different shares: those at its
/// start, subtrees against themselves, take far longer than two that hardly overlap.
const MAX_SUBTREE_SHARES: usize = 32;

/// Vertex stars in one share.
const STARS_PER_SHARE: usize = 1024;

/// Certificates of pairs of leaves in one share.
const PAIRS_PER_SHARE: usize = 1024;

/// Pairs of faces of two leaves.
const PAIRS_PER_LEAVES: u64 = (WIDTH * WIDTH) as u64;

/// Most certificates of pairs of leaves: for each face, or for small meshes in all. Cloth has about one for each face.
const CERTIFICATES_PER_FACE: usize = 4;
const MIN_CERTIFICATES: usize = 1 << 16;

/// So many contacts take milliseconds to sort and number.
const MANY_CONTACTS: usize = 1 << 14;

/// Finds all intersections of a frame, reusing its memory from frame to frame.
#[derive(Debug, Default)]
pub struct Intersector {
    bvh: Bvh,
    one_rings: OneRings,
    subtrees: Vec<NodePair>,
    shares: Vec<Share>,
    cache: CertificateCache,
    cached_shares: Vec<Share>,
    stack: Vec<NodePair>,
    contacts: Vec<([FaceId; 2], Contact)>,
    assembler: Assembler,
}

impl Intersector {
    /// Finds all intersections of `frame`.
    ///
    /// The answer is complete and exact: the same as that of testing every edge against every face. It does not depend
    /// on the number of threads, nor on frames that came before: what is cached from them only saves time.
    ///
    /// Pairs of faces that share a vertex come from the topology, which is fixed; all others from a bounding volume
    /// hierarchy.
    ///
    /// Cost: O(n log n) for n faces of bounded overlap and bounded numbers around a vertex, plus O(k log k) for k
    /// intersecting pairs.
    ///
    /// Pairs are tested as they are found and none is kept: memory is that of the tree, of certificates, of which there
    /// is a bounded number for each face, and of what intersects. [`intersect_within`](Self::intersect_within) bounds
    /// this as well.
    ///
    /// # Panics
    /// If the signs contradict each other, which consistent perturbation rules out.
    pub fn intersect(&mut self, mesh: &Mesh, frame: &Frame, found: &mut Intersections) {
        self.intersect_within(mesh, frame, SearchLimits::NONE, &mut (), found);
    }

    /// Finds all intersections of `frame`, or none where more pairs of faces intersect than `limits` allow, or where
    /// `observer` says that time is up: it is asked about every five milliseconds of work.
    ///
    /// Whether the limits are exceeded depends on the mesh and the frame alone.
    ///
    /// # Panics
    /// As [`intersect`](Self::intersect).
    pub fn intersect_within(
        &mut self,
        mesh: &Mesh,
        frame: &Frame,
        limits: SearchLimits,
        observer: &mut dyn StageObserver,
        found: &mut Intersections,
    ) -> SearchEnd {
        let mut rounds = Rounds::new(limits, observer);
        self.contacts.clear();
        found.clear();
        let mut end = self.search(mesh, frame, limits, &mut rounds);
        if end == SearchEnd::Complete && self.contacts.len() > MANY_CONTACTS && rounds.is_spent() {
            end = SearchEnd::OutOfTime;
        }
        if end == SearchEnd::Complete {
            self.contacts.sort_unstable_by_key(|&(faces, _)| faces);
            self.assembler.assemble(mesh, frame, &self.contacts, found);
        }
        end
    }

    /// Finds all contacts.
    fn search(&mut self, mesh: &Mesh, frame: &Frame, limits: SearchLimits, rounds: &mut Rounds<'_>) -> SearchEnd {
        if self.bvh.prepare(mesh, frame) {
            self.one_rings = OneRings::new(mesh, self.bvh.faces());
            self.cache.reset(mesh, &self.bvh, &self.one_rings);
        }
        let max_pairs = self.max_certificates(limits);
        if self.cache.pairs.len() > max_pairs {
            self.cache.clear();
        }
        match self.cache.advance(mesh, frame) {
            Mode::Cold => {
                self.bvh.refit(mesh, frame);
                self.cold_search(mesh, frame, rounds)
            }
            Mode::Rebuild => {
                self.bvh.refit(mesh, frame);
                if self.collect_leaf_pairs(max_pairs) {
                    self.cached_search(mesh, frame, rounds)
                } else {
                    self.cold_search(mesh, frame, rounds)
                }
            }
            Mode::Cached => self.cached_search(mesh, frame, rounds),
        }
    }

    /// Most pairs of leaves with a certificate: so few that the pairs of faces in them are within the limits, and that
    /// memory is bounded.
    fn max_certificates(&self, limits: SearchLimits) -> usize {
        let within_limits = usize::try_from(limits.max_tested / PAIRS_PER_LEAVES).unwrap_or(usize::MAX);
        MIN_CERTIFICATES.max(CERTIFICATES_PER_FACE * self.bvh.faces().len()).min(within_limits)
    }

    /// Collects the pairs of leaves that get certificates; false where there are too many, or where vertices are so far
    /// away that single precision does not tell how near boxes are.
    fn collect_leaf_pairs(&mut self, max_pairs: usize) -> bool {
        let Self { bvh, cache, stack, .. } = self;
        let (margin_m, mut is_complete) = (cache.margin_m(), false);
        let pairs = &mut cache.pairs;
        if !bvh.has_far() {
            dispatch(CollectLeafPairs { bvh, margin_m, max_pairs, stack, pairs, is_complete: &mut is_complete });
        }
        cache.keep_pairs(is_complete, bvh.scale())
    }

    /// Clears the cache, so that the next frame takes a cold search. Answers never depend on the cache: this is for
    /// measuring.
    pub fn clear_cache(&mut self) {
        self.cache.clear();
    }

    /// Finds all contacts without certificates.
    fn cold_search(&mut self, mesh: &Mesh, frame: &Frame, rounds: &mut Rounds<'_>) -> SearchEnd {
        self.bvh.subtree_pairs(MIN_SUBTREES, &mut self.subtrees);
        let (bvh, one_rings, subtrees) = (&self.bvh, &self.one_rings, &self.subtrees);
        let num_star_shares = one_rings.len().div_ceil(STARS_PER_SHARE);
        let num_subtree_shares = MAX_SUBTREE_SHARES.min(subtrees.len());
        let shares = at_least(&mut self.shares, num_subtree_shares + num_star_shares);
        let end = rounds.run(shares, |shares| {
            let (subtree_shares, star_shares) = shares.split_at_mut(num_subtree_shares);
            rayon::join(
                || {
                    let shares = subtree_shares.par_iter_mut().with_max_len(1).enumerate();
                    shares.filter(|(_, share)| !share.is_done).for_each(|(first, share)| {
                        let kind = SubtreePairs { all: subtrees, first, step: num_subtree_shares };
                        dispatch(Search { share, bvh, one_rings, mesh, frame, kind });
                    });
                },
                || {
                    let shares = star_shares.par_iter_mut().enumerate();
                    shares.filter(|(_, share)| !share.is_done).for_each(|(index, share)| {
                        let part =
                            |count: usize| index * count / num_star_shares..(index + 1) * count / num_star_shares;
                        let (batches, unbatched) = (part(one_rings.num_batches()), part(one_rings.unbatched().len()));
                        let kind = VertexStars { batches, unbatched };
                        dispatch(Search { share, bvh, one_rings, mesh, frame, kind });
                    });
                },
            );
        });
        gather(shares, end, &mut self.contacts)
    }

    /// Finds all contacts, searching only where certificates have expired.
    fn cached_search(&mut self, mesh: &Mesh, frame: &Frame, rounds: &mut Rounds<'_>) -> SearchEnd {
        let (bvh, one_rings) = (&self.bvh, &self.one_rings);
        let margin_m = self.cache.margin_m();
        let cache = self.cache.certificates_mut();
        let num_pair_shares = cache.pairs.len().div_ceil(PAIRS_PER_SHARE);
        let num_star_shares = cache.stars_m.len().div_ceil(STARS_PER_SHARE);
        let shares = at_least(&mut self.cached_shares, num_pair_shares + num_star_shares);
        let (leaf_times_m, latest_m) = (cache.leaf_times_m, cache.latest_m);
        let end = rounds.run(shares, |shares| {
            let (pair_shares, star_shares) = shares.split_at_mut(num_pair_shares);
            rayon::join(
                || {
                    let pairs = cache.pairs.par_chunks_mut(PAIRS_PER_SHARE);
                    let groups = cache.pair_groups_m.par_chunks_mut(PAIRS_PER_SHARE / PAIRS_PER_GROUP);
                    let chunks = pairs.zip(groups).zip(pair_shares).filter(|(_, share)| !share.is_done);
                    chunks.for_each(|((pairs, groups_m), share)| {
                        let kind = ExpiredLeafPairs { pairs, groups_m, leaf_times_m, latest_m, margin_m };
                        dispatch(Search { share, bvh, one_rings, mesh, frame, kind });
                    });
                },
                || {
                    let stars = cache.stars_m.par_chunks_mut(STARS_PER_SHARE);
                    let groups = cache.star_groups_m.par_chunks_mut(STARS_PER_SHARE / STARS_PER_GROUP);
                    let times = cache.star_times_m.par_chunks(STARS_PER_SHARE / STARS_PER_GROUP);
                    let chunks = stars.zip(groups).zip(times).zip(star_shares).enumerate();
                    let chunks = chunks.filter(|(_, (_, share))| !share.is_done);
                    chunks.for_each(|(index, (((stars_m, groups_m), times_m), share))| {
                        let kind = ExpiredStars { start: index * STARS_PER_SHARE, stars_m, groups_m, times_m };
                        dispatch(Search { share, bvh, one_rings, mesh, frame, kind });
                    });
                },
            );
        });
        gather(shares, end, &mut self.contacts)
    }
}

/// Takes the contacts of all shares together, if the search is complete.
fn gather(shares: &[Share], end: SearchEnd, contacts: &mut Vec<([FaceId; 2], Contact)>) -> SearchEnd {
    if end == SearchEnd::Complete {
        shares.iter().for_each(|share| contacts.extend_from_slice(&share.contacts));
    }
    end
}

/// The first `count` shares, of which more are added where there are fewer.
fn at_least(shares: &mut Vec<Share>, count: usize) -> &mut [Share] {
    if shares.len() < count {
        shares.resize_with(count, Share::default);
    }
    &mut shares[..count]
}
