//! All pairs below a distance.

use rayon::prelude::*;

use super::{
    candidates::Candidates,
    elements::Elements,
    nearest::{Bound, LeafNearest, Nearest, SubtreeNearest},
    pair::ProximityPair,
};
use crate::{
    frame::Frame,
    intersect::{Bvh, NodePair},
    mesh::Mesh,
    simd::{InstructionSet, Task, dispatch},
};

/// Nodes of the level from which on subtrees are traversed in parallel, at least, where the tree has as many.
const MIN_SUBTREES: usize = 32;
/// Leaves that one thread takes at a time.
const LEAVES_PER_TASK: usize = 64;

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
    elements: Elements,
    subtrees: Vec<NodePair>,
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
        let margin = self.bvh.margin_f32(distance_m);
        self.bvh.near_subtrees(margin, MIN_SUBTREES, &mut self.subtrees);
        let candidates = self.candidates(mesh);
        let mut shares: Vec<Vec<ProximityPair>> = Vec::new();
        let share = |&subtrees: &NodePair| {
            let mut pairs = Vec::new();
            dispatch(FindBelow { candidates, frame, margin, distance_m, max_pairs, subtrees, pairs: &mut pairs });
            pairs
        };
        self.subtrees.par_iter().with_max_len(1).map(share).collect_into_vec(&mut shares);
        if shares.iter().map(Vec::len).sum::<usize>() > max_pairs {
            return ProximityEnd::TooManyPairs;
        }
        found.extend(shares.into_iter().flatten());
        found.sort_unstable_by_key(|pair| pair.primitives);
        ProximityEnd::Complete
    }

    /// The nearest pair, of equally near ones the first; nothing where no two primitives are without a common vertex.
    ///
    /// Cost: O(n log n) for n faces of about the same size.
    pub fn nearest(&mut self, mesh: &Mesh, frame: &Frame) -> Option<ProximityPair> {
        self.prepare(mesh, frame);
        let bound = Bound::default();
        // Neighbours in a leaf give a bound for the rest.
        let candidates = self.candidates(mesh);
        let of_leaf = |leaves: NodePair| {
            let mut best = Nearest::default();
            dispatch(LeafNearest { candidates, frame, bound: &bound, leaves, best: &mut best });
            best
        };
        let leaves = self.bvh.leaves_with_themselves().with_min_len(LEAVES_PER_TASK);
        let best = leaves.map(of_leaf).reduce(Nearest::default, Nearest::nearer);
        self.bvh.near_subtrees(self.bvh.margin_f32(bound.get()), MIN_SUBTREES, &mut self.subtrees);
        let candidates = self.candidates(mesh);
        let of_subtrees = |&subtrees: &NodePair| {
            let mut best = Nearest::default();
            dispatch(SubtreeNearest { candidates, frame, bound: &bound, subtrees, best: &mut best });
            best
        };
        let others = self.subtrees.par_iter().with_max_len(1).map(of_subtrees);
        best.nearer(others.reduce(Nearest::default, Nearest::nearer)).pair
    }

    /// Fits the tree to a frame.
    fn prepare(&mut self, mesh: &Mesh, frame: &Frame) {
        if self.bvh.prepare(mesh, frame) {
            self.elements = Elements::new(mesh, &self.bvh);
        }
        self.bvh.refit(frame);
        self.elements.refit(self.bvh.points_f32());
    }

    fn candidates<'a>(&'a self, mesh: &'a Mesh) -> Candidates<'a> {
        Candidates { mesh, bvh: &self.bvh, elements: &self.elements }
    }
}

/// Finds the pairs below a distance in a pair of subtrees; ends early with more than `max_pairs`.
struct FindBelow<'a> {
    candidates: Candidates<'a>,
    frame: &'a Frame,
    margin: f32,
    distance_m: f64,
    max_pairs: usize,
    subtrees: NodePair,
    pairs: &'a mut Vec<ProximityPair>,
}

impl Task for FindBelow<'_> {
    #[inline(always)]
    fn run<S: InstructionSet>(self, simd: S) {
        let Self { candidates, frame, margin, distance_m, max_pairs, subtrees, pairs } = self;
        let mesh = candidates.mesh;
        candidates.bvh.near_nodes(simd, margin, 0, &mut vec![subtrees], |leaves| {
            if pairs.len() > max_pairs {
                return;
            }
            candidates.of_leaves(simd, margin, leaves, |primitives| {
                if primitives.are_nearer(mesh, frame, distance_m) {
                    // Rounding must not contradict the exact answer.
                    let rounded = primitives.distance_m(mesh, frame).min(distance_m.next_down());
                    pairs.push(ProximityPair { primitives, distance_m: rounded });
                }
            });
        });
    }
}
