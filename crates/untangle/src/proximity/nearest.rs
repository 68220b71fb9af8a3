//! The nearest pair, by branch and bound on the tree: what is farther apart than the nearest pair so far is not looked
//! at. The bound is shared by all threads, so that the time depends on them, but not the answer.

use std::sync::atomic::{AtomicU64, Ordering};

use super::{
    candidates::Candidates,
    pair::{Primitives, ProximityPair},
};
use crate::{
    frame::Frame,
    intersect::NodePair,
    simd::{InstructionSet, Task},
};

/// A distance that only gets smaller, in metres.
#[derive(Debug)]
pub(super) struct Bound(AtomicU64);

impl Default for Bound {
    fn default() -> Self {
        Self(AtomicU64::new(f64::INFINITY.to_bits()))
    }
}

impl Bound {
    pub(super) fn get(&self) -> f64 {
        f64::from_bits(self.0.load(Ordering::Relaxed))
    }

    fn lower_to(&self, distance_m: f64) {
        // Numbers that are not negative are ordered as their bits are.
        self.0.fetch_min(distance_m.to_bits(), Ordering::Relaxed);
    }
}

/// The nearest pair so far.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Nearest {
    pub(super) pair: Option<ProximityPair>,
}

impl Nearest {
    /// The nearer of two; of equally near ones the first.
    pub(super) fn nearer(self, other: Self) -> Self {
        let key = |pair: &ProximityPair| (pair.distance_m, pair.primitives);
        match (self.pair, other.pair) {
            (Some(a), Some(b)) if key(&b) < key(&a) => other,
            (None, _) => other,
            _ => self,
        }
    }

    fn offer(&mut self, candidates: &Candidates<'_>, frame: &Frame, bound: &Bound, primitives: Primitives) {
        let distance_m = primitives.distance_m(candidates.mesh, frame);
        if distance_m <= bound.get() {
            bound.lower_to(distance_m);
            *self = self.nearer(Self { pair: Some(ProximityPair { primitives, distance_m }) });
        }
    }
}

/// Looks for the nearest pair in a pair of leaves.
pub(super) struct LeafNearest<'a> {
    pub(super) candidates: Candidates<'a>,
    pub(super) frame: &'a Frame,
    pub(super) bound: &'a Bound,
    pub(super) leaves: NodePair,
    pub(super) best: &'a mut Nearest,
}

impl Task for LeafNearest<'_> {
    #[inline(always)]
    fn run<S: InstructionSet>(self, simd: S) {
        let Self { candidates, frame, bound, leaves, best } = self;
        let margin = candidates.bvh.margin_f32(bound.get());
        candidates.of_leaves(simd, margin, leaves, |primitives| best.offer(&candidates, frame, bound, primitives));
    }
}

/// Looks for the nearest pair in a pair of subtrees.
pub(super) struct SubtreeNearest<'a> {
    pub(super) candidates: Candidates<'a>,
    pub(super) frame: &'a Frame,
    pub(super) bound: &'a Bound,
    pub(super) subtrees: NodePair,
    pub(super) best: &'a mut Nearest,
}

impl Task for SubtreeNearest<'_> {
    #[inline(always)]
    fn run<S: InstructionSet>(self, simd: S) {
        let Self { candidates, frame, bound, subtrees, best } = self;
        let margin = candidates.bvh.margin_f32(bound.get());
        candidates.bvh.near_nodes(simd, margin, 0, &mut vec![subtrees], |leaves| {
            let margin = candidates.bvh.margin_f32(bound.get());
            candidates.of_leaves(simd, margin, leaves, |primitives| best.offer(&candidates, frame, bound, primitives));
        });
    }
}
