//! What is looked for: all pairs below a distance, or the nearest one.

use std::sync::atomic::{AtomicU64, Ordering};

use super::pair::{Primitives, ProximityPair};
use crate::{frame::Frame, intersect::Bvh, mesh::Mesh};

/// A distance that only gets smaller, in metres. It is shared by all threads, so that the time depends on them, but not
/// the answer.
#[derive(Debug)]
pub(super) struct Bound(AtomicU64);

impl Default for Bound {
    fn default() -> Self {
        Self(AtomicU64::new(f64::INFINITY.to_bits()))
    }
}

impl Bound {
    fn get(&self) -> f64 {
        f64::from_bits(self.0.load(Ordering::Relaxed))
    }

    fn lower_to(&self, distance_m: f64) {
        // Numbers that are not negative are ordered as their bits are.
        self.0.fetch_min(distance_m.to_bits(), Ordering::Relaxed);
    }
}

/// What a search is for.
#[derive(Clone, Copy)]
pub(super) enum Goal<'a> {
    /// All pairs below a distance; more than so many in one share are not wanted.
    Below { distance_m: f64, max_pairs: usize },
    /// The nearest pair, by branch and bound: what is farther apart than the nearest so far is not looked at.
    Nearest { bound: &'a Bound },
}

impl Goal<'_> {
    /// The margin within which pairs are looked for now, after the map of the tree.
    pub(super) fn margin(&self, bvh: &Bvh) -> f32 {
        bvh.margin_f32(match self {
            Self::Below { distance_m, .. } => *distance_m,
            Self::Nearest { bound } => bound.get(),
        })
    }

    /// Whether no more pairs are wanted.
    pub(super) fn is_over(&self, found: &[ProximityPair]) -> bool {
        matches!(self, Self::Below { max_pairs, .. } if found.len() > *max_pairs)
    }

    /// Decides about a pair, exactly where it is about a given distance, and takes it if it is wanted.
    pub(super) fn offer(&self, mesh: &Mesh, frame: &Frame, primitives: Primitives, found: &mut Vec<ProximityPair>) {
        match self {
            Self::Below { distance_m: below_m, .. } => {
                if let Some(rounded_m) = primitives.distance_below(mesh, frame, *below_m) {
                    // Rounding must not contradict the exact answer.
                    found.push(ProximityPair { primitives, distance_m: rounded_m.min(below_m.next_down()) });
                }
            }
            Self::Nearest { bound } => {
                let distance_m = primitives.distance_m(mesh, frame);
                if distance_m <= bound.get() {
                    bound.lower_to(distance_m);
                    let pair = ProximityPair { primitives, distance_m };
                    let nearest = found.pop().map_or(pair, |other| nearer(pair, other));
                    found.push(nearest);
                }
            }
        }
    }
}

/// The nearer of two; of equally near ones the first.
pub(super) fn nearer(a: ProximityPair, b: ProximityPair) -> ProximityPair {
    let key = |pair: &ProximityPair| (pair.distance_m, pair.primitives);
    if key(&b) < key(&a) { b } else { a }
}
