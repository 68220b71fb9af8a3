//! The search: open stars first, then all pairs of faces, in shares.

use rayon::prelude::*;

use super::{
    goal::{Bound, Goal, nearer},
    owners::Owners,
    pair::ProximityPair,
    share::{Part, Scene, Share, Work},
    stars::{Stars, TestStars},
};
use crate::{
    frame::Frame,
    intersect::{Bvh, NodePair},
    mesh::Mesh,
    simd::dispatch,
};

/// Nodes of the level from which on subtrees are traversed in parallel, at least, where the tree has as many.
const MIN_SUBTREES: usize = 32;
/// Shares of the pairs of subtrees. Neighbours in their list go to different shares.
const MAX_SUBTREE_SHARES: usize = 32;
/// Vertex stars in one share: tested ones, and open ones.
const STARS_PER_SHARE: usize = 1024;
const OPEN_STARS_PER_SHARE: usize = 256;
/// Leaves whose faces give a first bound for the nearest pair.
const NUM_SAMPLES: usize = 64;

/// How a search ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProximityEnd {
    /// All pairs were found.
    Complete,
    /// There are more than the limit.
    TooManyPairs,
}

/// Finds pairs of primitives by their distance, reusing its memory from frame to frame of a mesh.
#[derive(Debug, Default)]
pub struct ProximitySearch {
    bvh: Bvh,
    owners: Owners,
    stars: Stars,
    subtrees: Vec<NodePair>,
    shares: Vec<Share>,
}

impl ProximitySearch {
    /// Finds all pairs whose distance is below `distance_m`, each once, ascending by primitives; none where there are
    /// more than `max_pairs`. The same on any number of threads.
    ///
    /// Cost: O(n log n + k log k) for n faces and k pairs, for a distance of no more than about an edge. Memory is that
    /// of the tree and of the pairs. Round a vertex of m faces both grow with the square of m.
    pub fn find(
        &mut self,
        mesh: &Mesh,
        frame: &Frame,
        distance_m: f64,
        max_pairs: usize,
        found: &mut Vec<ProximityPair>,
    ) -> ProximityEnd {
        found.clear();
        self.prepare(mesh, frame);
        self.run(mesh, frame, Goal::Below { distance_m, max_pairs });
        if self.shares.iter().map(|share| share.found.len()).sum::<usize>() > max_pairs {
            return ProximityEnd::TooManyPairs;
        }
        self.shares.iter().for_each(|share| found.extend_from_slice(&share.found));
        found.sort_unstable_by_key(|pair| pair.primitives.rank());
        ProximityEnd::Complete
    }

    /// The nearest pair, of equally near ones the first; nothing where no two primitives are without a common vertex.
    ///
    /// Cost: O(n log n) for n faces of about the same size.
    pub fn nearest(&mut self, mesh: &Mesh, frame: &Frame) -> Option<ProximityPair> {
        self.prepare(mesh, frame);
        let bound = Bound::default();
        let goal = Goal::Nearest { bound: &bound };
        // Neighbours in some leaves give a bound for all.
        let num_leaves = self.bvh.num_leaves();
        let samples: Vec<usize> = (0..num_leaves).step_by(num_leaves.div_ceil(NUM_SAMPLES).max(1)).collect();
        let Self { bvh, owners, stars, shares, .. } = self;
        let scene = Scene { mesh, frame, bvh, owners, stars, goal };
        let share = &mut begin(shares, 1)[0];
        dispatch(Work { scene, share, part: Part::Leaves(&samples) });
        let first = share.found.pop();
        self.run(mesh, frame, goal);
        self.shares.iter().filter_map(|share| share.found.last().copied()).chain(first).reduce(nearer)
    }

    /// Fits the tree to a frame.
    fn prepare(&mut self, mesh: &Mesh, frame: &Frame) {
        if self.bvh.prepare(mesh, frame) {
            self.owners = Owners::new(mesh, &self.bvh);
            self.stars = Stars::new(mesh, &self.bvh);
        }
        self.bvh.refit(frame);
    }

    /// Looks for what is wanted; what is found stays in the shares.
    fn run(&mut self, mesh: &Mesh, frame: &Frame, goal: Goal<'_>) {
        let margin = goal.margin(&self.bvh);
        self.test_stars(margin);
        self.bvh.near_subtrees(margin, MIN_SUBTREES, &mut self.subtrees);
        let Self { bvh, owners, stars, subtrees, shares } = self;
        let num_subtree_shares = MAX_SUBTREE_SHARES.min(subtrees.len());
        let num_star_shares = stars.open.len().div_ceil(OPEN_STARS_PER_SHARE);
        let shares = begin(shares, num_subtree_shares + num_star_shares);
        let scene = Scene { mesh, frame, bvh, owners, stars, goal };
        shares.par_iter_mut().with_max_len(1).enumerate().for_each(|(index, share)| {
            let part = match index.checked_sub(num_subtree_shares) {
                None => Part::Subtrees { all: subtrees, first: index, step: num_subtree_shares },
                Some(index) => {
                    let open = &stars.open[OPEN_STARS_PER_SHARE * index..];
                    Part::Stars(&open[..OPEN_STARS_PER_SHARE.min(open.len())])
                }
            };
            dispatch(Work { scene, share, part });
        });
    }

    /// Tests all stars.
    fn test_stars(&mut self, margin: f32) {
        let Self { bvh, stars, shares, .. } = self;
        stars.begin();
        let rings = &stars.rings;
        let num_shares = rings.len().div_ceil(STARS_PER_SHARE);
        let shares = begin(shares, num_shares);
        shares.par_iter_mut().enumerate().for_each(|(index, share)| {
            let part = |count: usize| index * count / num_shares..(index + 1) * count / num_shares;
            let (batches, unbatched) = (part(rings.num_batches()), part(rings.unbatched().len()));
            let Share { spokes, open, .. } = share;
            dispatch(TestStars { bvh, rings, margin, batches, unbatched, spokes, open });
        });
        for share in shares {
            stars.open(&share.open);
        }
    }
}

/// So many shares, emptied. Others, of an earlier search, are emptied as well.
fn begin(shares: &mut Vec<Share>, count: usize) -> &mut [Share] {
    if shares.len() < count {
        shares.resize_with(count, Share::default);
    }
    for share in &mut *shares {
        share.found.clear();
        share.open.clear();
    }
    &mut shares[..count]
}
