//! How good a state is, island by island.

use nalgebra::Point3;

use crate::relax::{
    energy::ArapEnergy,
    step::{Islands, Tangle},
};

/// Strains below this logarithm count for nothing.
const SMALL_STRAIN: f64 = 0.05;
/// What the sum of all distances from the input, in edges, counts for beside an edge-face intersection.
const MOVED_WEIGHT: f64 = 0.001;

/// How good a state is for one island: less is better.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Score {
    pub(super) tangle: Tangle,
    /// How far its motions still have to go, weighted.
    pub(super) depth: f64,
    /// The largest logarithm of an edge's length over that in the input.
    pub(super) strain: f64,
    /// The sum of the distances of vertices from their places in the input, in mean edge lengths.
    pub(super) moved_edges: f64,
}

impl Score {
    /// Less is better.
    pub(super) fn merit(&self) -> f64 {
        self.tangle.merit() + self.depth
    }

    /// The merit, where strain counts as well.
    pub(super) fn value(&self) -> f64 {
        (self.merit() + 0.5) * (1.0 + (self.strain - SMALL_STRAIN).max(0.0)) + MOVED_WEIGHT * self.moved_edges
    }
}

/// Adds how far vertices are from their places in the input.
pub(super) fn add_moved(
    energy: ArapEnergy<'_>,
    islands: &Islands,
    positions: &[Point3<f64>],
    edge_length_m: f64,
    scores: &mut [Score],
) {
    for &vertex in energy.domain.vertices() {
        let moved_m = (positions[vertex.index()] - energy.rest.position(vertex)).norm();
        scores[islands.of(vertex)].moved_edges += moved_m / edge_length_m;
    }
}
