//! What a caller gets.

use std::collections::BTreeMap;

use thiserror::Error;

use super::super::outcome::Iteration;

/// Why a pair of primitives can't be set apart.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq, PartialOrd, Ord)]
pub enum ClearanceObstacle {
    /// All vertices of both are pinned.
    #[error("all its vertices are pinned")]
    Pinned,
    /// A way along the surface between them is shorter than the gap.
    #[error("neighbours on the surface, nearer along it than the gap")]
    Surface,
    /// No step set them further apart.
    #[error("no motion set it further apart: it is held from both sides, or the cloth would be overstretched")]
    Held,
    /// The same, where some vertices near it are pinned.
    #[error("no motion set it further apart: some of its vertices are pinned")]
    PartlyPinned,
    /// It lies at or beside a tangle: where something intersects, or is on the wrong side.
    #[error("a tangle is left there, which has to be resolved first")]
    Tangled,
    /// The work ended before.
    #[error("the work was ended before it was set apart")]
    Ended,
}

/// Pairs of primitives, connected by common vertices, that stayed nearer than the gap.
#[derive(Clone, Debug, PartialEq)]
pub struct InfeasiblePlace {
    /// Their vertices, ascending.
    pub vertices: Vec<u32>,
    /// How many pairs there are.
    pub num_pairs: usize,
    /// The least of their distances, in metres.
    pub distance_m: f64,
    /// Why.
    pub obstacle: ClearanceObstacle,
}

/// The best state found, and how it came about.
#[derive(Clone, Debug, PartialEq)]
pub struct Clearance {
    /// Positions in metres, `num_vertices x 3`; vertices that did not have to move keep their bits.
    pub positions: Vec<[f64; 3]>,
    /// One entry for each iteration.
    pub history: Vec<Iteration>,
    /// Pairs that are nearer than the gap in `positions`, exactly, in double precision.
    pub num_pairs_below: usize,
    /// Where pairs stayed nearer than the gap, in either precision, the nearest first.
    pub infeasible: Vec<InfeasiblePlace>,
    /// Whether the caller ended it.
    pub interrupted: bool,
}

/// A pair that stayed below the gap: its vertices, its distance in metres, and why.
pub(super) type Left = (Vec<u32>, f64, ClearanceObstacle);

/// Puts pairs together that have vertices in common and the same obstacle.
pub(super) fn places(left: Vec<Left>) -> Vec<InfeasiblePlace> {
    // Disjoint sets of pairs, joined over the first pair at each vertex.
    let mut parents: Vec<usize> = (0..left.len()).collect();
    let mut first: BTreeMap<(ClearanceObstacle, u32), usize> = BTreeMap::new();
    for (index, (vertices, _, obstacle)) in left.iter().enumerate() {
        for &vertex in vertices {
            let other = *first.entry((*obstacle, vertex)).or_insert(index);
            let [a, b] = [root(&mut parents, index), root(&mut parents, other)];
            parents[a.max(b)] = a.min(b);
        }
    }
    let mut by_root: BTreeMap<usize, InfeasiblePlace> = BTreeMap::new();
    for (index, (vertices, distance_m, obstacle)) in left.into_iter().enumerate() {
        let place = by_root.entry(root(&mut parents, index)).or_insert_with(|| InfeasiblePlace {
            vertices: Vec::new(),
            num_pairs: 0,
            distance_m,
            obstacle,
        });
        place.vertices.extend(vertices);
        place.num_pairs += 1;
        place.distance_m = place.distance_m.min(distance_m);
    }
    let mut places: Vec<InfeasiblePlace> = by_root.into_values().collect();
    for place in &mut places {
        place.vertices.sort_unstable();
        place.vertices.dedup();
    }
    places.sort_by(|a, b| a.distance_m.total_cmp(&b.distance_m));
    places
}

fn root(parents: &mut [usize], mut index: usize) -> usize {
    while parents[index] != index {
        parents[index] = parents[parents[index]];
        index = parents[index];
    }
    index
}
