//! Which motions are tried.

use super::{Quality, candidate::Try, goals::Aim};
use crate::settings::InsideChoice;

/// Motions of one iteration stiffen edges that change their length by more than this factor, in the careful kind of motion.
pub(super) const TOLERATED: f64 = 1.08;

/// A way through all iterations.
#[derive(Clone, Copy, Debug)]
pub(super) enum Plan {
    /// Motions with an aim that is tried first, and a choice of the side of a path that is its inside.
    Motions { aim: Aim, inside: InsideChoice },
    /// Flat, and back.
    Straighten,
}

/// Tangles with more edge-face intersections than this begin with what is last for others: a motion that has to reach so many goals takes
/// minutes, and those goals contradict each other anyway.
const HOPELESS: usize = 2500;

/// Whether a cluster of so many edge-face intersections is left to straightening.
pub(super) fn is_hopeless(num_edge_face: usize) -> bool {
    num_edge_face > HOPELESS
}

/// Iterations of tangles larger than this take seconds, and those that motions bring apart are seen to give way at once.
const LARGE: usize = 500;

/// The ways to go: where one ends stuck, the next begins again from the input. `largest` is the number of edge-face intersections of the
/// cluster of paths that has most.
pub(super) fn plans(largest: usize) -> [Plan; 5] {
    let motions = |aim, inside| Plan::Motions { aim, inside };
    let (normal, target) = (motions(Aim::Normal, InsideChoice::Work), motions(Aim::Target, InsideChoice::Work));
    let [a, b, c] = if is_hopeless(largest) {
        [Plan::Straighten, normal, target]
    } else if largest > LARGE {
        [normal, Plan::Straighten, target]
    } else {
        [normal, target, Plan::Straighten]
    };
    [a, b, c, motions(Aim::Normal, InsideChoice::Count), motions(Aim::Target, InsideChoice::Count)]
}

/// A plan is given up when this many iterations have taken away too small a part of what was left before them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Patience {
    num_iterations: usize,
    /// What has to be left at most, as a part.
    left: f64,
}

impl Patience {
    /// About the same pace for all tangles, but looked at sooner where an iteration takes long.
    pub(super) fn with(largest: usize) -> Self {
        if largest > LARGE { Self { num_iterations: 2, left: 0.9 } } else { Self { num_iterations: 5, left: 0.75 } }
    }

    /// Whether the last of these merits, one for each state, show too little progress. The first iteration, which keeps no shape, does not
    /// count.
    pub(super) fn is_over(self, merits: &[f64]) -> bool {
        let now = merits.len() - 1;
        now > self.num_iterations && merits[now] > self.left * merits[now - self.num_iterations]
    }
}

/// The motions that are tried; `widen` adds those of the other aims.
pub(super) fn tries(first: Aim, quality: Quality, widen: bool) -> Vec<Try> {
    let others = if first == Aim::Normal { [Aim::Target, Aim::Shorten] } else { [Aim::Normal, Aim::Shorten] };
    let stiffnesses: &[f64] = if quality == Quality::Fast { &[16.0] } else { &[1.0, 16.0, 256.0] };
    let mut tries = Vec::new();
    for &stiffness in stiffnesses {
        for tolerated in [f64::INFINITY, TOLERATED] {
            tries.push(Try { aim: first, stiffness, tolerated });
        }
    }
    if widen {
        for stiffness in [1.0, 16.0, 256.0] {
            for aim in others {
                tries.push(Try { aim, stiffness, tolerated: f64::INFINITY });
                if quality == Quality::Accurate {
                    tries.push(Try { aim, stiffness, tolerated: TOLERATED });
                }
            }
        }
    }
    tries
}
