//! Which trial displacements are made, and in which order of plans.

mod copies;

pub(super) use copies::are_copies_in_one_place;

use super::{constraints::Objective, settings::Effort, step::TrialSettings};
use crate::settings::InsideChoice;

/// Trials with a limit on stretch make edges stiffer that change their length by more than this factor.
pub(super) const MAX_STRETCH: f64 = 1.08;

/// A plan for all iterations. Where one ends stuck, the next begins again from the input.
#[derive(Clone, Copy, Debug)]
pub(super) enum Plan {
    /// Trial displacements with an objective that is tried first, and a choice of the side of a path that is its
    /// inside.
    Resolve { objective: Objective, inside: InsideChoice, pace: Pace },
    /// The flattening flow, and shape recovery after it.
    Flatten,
}

/// How much time a plan of trials gets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pace {
    /// Trials of the caller's effort, given up where progress stalls.
    Usual,
    /// The fewest trials, given up where one iteration does not take away a good part of the tangle.
    Quick,
}

/// With more edge-face intersections than this a displacement takes long.
const MAX_FOR_TRIALS: usize = 2500;
/// The constraints of more paths than this, in one island, contradict each other. The number of paths does not depend
/// on how fine a mesh is, that of edge-face intersections does.
const MAX_PATHS: usize = 60;

/// Whether trials of so many edge-face intersections take long.
pub(super) fn is_beyond_trials(num_edge_face: usize) -> bool {
    num_edge_face > MAX_FOR_TRIALS
}

/// The island with most edge-face intersections.
#[derive(Clone, Copy, Debug)]
pub(super) struct Largest {
    pub(super) num_edge_face: usize,
    /// Path pairs in it.
    pub(super) num_pairs: usize,
    /// The part of all edge-face intersections that a piece with a boundary has with itself: flattening resolves these.
    pub(super) flattenable: f64,
    /// Whether most of what intersects is copies of one surface in nearly one place.
    pub(super) is_copy: bool,
}

impl Largest {
    /// Whether iterations take seconds.
    pub(super) fn is_large(self) -> bool {
        self.num_edge_face > LARGE
    }

    /// Whether it is so large, of so many paths, that trials hardly help: a crumple, or surfaces that nearly coincide.
    pub(super) fn is_crowded(self) -> bool {
        self.is_copy && self.num_edge_face > LARGE || is_beyond_trials(self.num_edge_face) && self.has_many_paths()
    }

    /// Whether so many paths meet that motions of single ones contradict each other: a crumple.
    pub(super) fn has_many_paths(self) -> bool {
        self.num_pairs > MAX_PATHS
    }
}

/// Iterations of tangles larger than this take seconds, and where trials can resolve them they help from the first
/// iteration on.
const LARGE: usize = 500;

/// Where more than this part of a crowded tangle can be flattened, that comes first.
const MOST: f64 = 0.5;

/// The plans in order: local displacements first, but for crumples, where flattening is quicker and they fail.
/// Flattening of pieces that only meet other pieces is tried last, and not at all where it takes long.
pub(super) fn plans(largest: Largest) -> Vec<Plan> {
    let resolve = |objective, inside| Plan::Resolve { objective, inside, pace: Pace::Usual };
    let normal = resolve(Objective::Normal, InsideChoice::Work);
    let target = resolve(Objective::Target, InsideChoice::Work);
    let others = [Objective::Normal, Objective::Target].map(|objective| resolve(objective, InsideChoice::Count));
    if largest.is_crowded() {
        let quick = Plan::Resolve { objective: Objective::Normal, inside: InsideChoice::Count, pace: Pace::Quick };
        if largest.is_copy {
            // Drawing whole pieces flat sets no copies apart.
            return vec![quick];
        }
        return if largest.flattenable > MOST { vec![Plan::Flatten, quick] } else { vec![quick, Plan::Flatten] };
    }
    let first =
        if largest.num_edge_face <= LARGE { [normal, target, Plan::Flatten] } else { [normal, Plan::Flatten, target] };
    [first.as_slice(), others.as_slice()].concat()
}

/// The plans where nothing intersects, and cloth is on the wrong side only: objectives and insides are those of paths,
/// and without any all plans of trials are one.
pub(super) fn plans_without_paths() -> Vec<Plan> {
    vec![Plan::Resolve { objective: Objective::Normal, inside: InsideChoice::Work, pace: Pace::Usual }]
}

/// When a plan is given up: this many iterations have removed too small a part of the tangle before them.
#[derive(Clone, Copy, Debug)]
pub(super) struct StallCriterion {
    num_iterations: usize,
    /// Largest ratio of the merits after and before that still counts as progress.
    max_ratio: f64,
}

impl StallCriterion {
    /// About the same pace for all tangles, but over fewer iterations where one takes long.
    pub(super) fn with(largest: usize, pace: Pace) -> Self {
        if pace == Pace::Quick {
            Self { num_iterations: 1, max_ratio: 0.6 }
        } else if largest > LARGE {
            Self { num_iterations: 2, max_ratio: 0.9 }
        } else {
            Self { num_iterations: 5, max_ratio: 0.75 }
        }
    }

    /// Whether the last of these merits, one for each state, show too little progress. The first iteration, which draws
    /// nothing towards the rest shape, does not count.
    pub(super) fn is_met(self, merits: &[f64]) -> bool {
        let now = merits.len() - 1;
        now > self.num_iterations && merits[now] > self.max_ratio * merits[now - self.num_iterations]
    }
}

/// The trials of one iteration; `widen` adds those with the other objectives.
pub(super) fn trials(first: Objective, effort: Effort, widen: bool) -> Vec<TrialSettings> {
    let others = match first {
        Objective::Normal => [Objective::Target, Objective::Shorten],
        Objective::Target | Objective::Shorten => [Objective::Normal, Objective::Shorten],
    };
    let stiffnesses: &[f64] = if effort == Effort::Fast { &[16.0] } else { &[1.0, 16.0, 256.0] };
    let mut trials = Vec::new();
    for &stiffness in stiffnesses {
        for max_stretch in [f64::INFINITY, MAX_STRETCH] {
            trials.push(TrialSettings { objective: first, stiffness, max_stretch });
        }
    }
    if widen {
        for stiffness in [1.0, 16.0, 256.0] {
            for objective in others {
                trials.push(TrialSettings { objective, stiffness, max_stretch: f64::INFINITY });
                if effort == Effort::Accurate {
                    trials.push(TrialSettings { objective, stiffness, max_stretch: MAX_STRETCH });
                }
            }
        }
    }
    trials
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn trials_with_more_effort_include_those_with_less() {
        for (widen, nums) in [(false, [2, 6, 6]), (true, [8, 12, 18])] {
            let all = [Effort::Fast, Effort::Balanced, Effort::Accurate]
                .map(|effort| trials(Objective::Target, effort, widen));
            assert_eq!([0, 1, 2].map(|k| all[k].len()), nums);
            for pair in all.windows(2) {
                assert!(pair[0].iter().all(|trial| pair[1].contains(trial)));
            }
        }
    }

    #[test]
    fn plans_of_larger_islands_flatten_earlier() {
        let place = |num_edge_face, num_pairs, flattenable| {
            let largest = Largest { num_edge_face, num_pairs, flattenable, is_copy: false };
            plans(largest).iter().position(|plan| matches!(plan, Plan::Flatten))
        };
        assert_eq!(place(10, 2, 1.0), Some(2));
        assert_eq!(place(LARGE + 1, 2, 1.0), Some(1));
        // Many intersections of few paths are those of a fine mesh.
        assert_eq!(place(MAX_FOR_TRIALS + 1, MAX_PATHS, 1.0), Some(1));
        assert_eq!(place(MAX_FOR_TRIALS + 1, MAX_PATHS + 1, 1.0), Some(0));
        assert_eq!(place(MAX_FOR_TRIALS + 1, MAX_PATHS + 1, 0.1), Some(1));
    }

    #[test]
    fn stall_criterion_with_slow_progress_is_met_after_its_window() {
        let stall = StallCriterion::with(10, Pace::Usual);
        let slow = [8.0, 7.9, 7.8, 7.7, 7.6, 7.5, 7.4];
        assert!(!stall.is_met(&slow[..6]) && stall.is_met(&slow));
        let fast = [8.0, 7.0, 6.0, 5.0, 4.0, 3.0, 2.0];
        assert!(!stall.is_met(&fast));
        let quick = StallCriterion::with(10, Pace::Quick);
        assert!(!quick.is_met(&fast[..2]) && quick.is_met(&fast[..3]));
    }
}
