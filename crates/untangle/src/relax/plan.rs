//! Which trial displacements are made, and in which order of plans.

use super::{constraints::Objective, settings::Effort, step::TrialSettings};
use crate::settings::InsideChoice;

/// Trials with a limit on stretch make edges stiffer that change their length by more than this factor.
pub(super) const MAX_STRETCH: f64 = 1.08;

/// A plan for all iterations. Where one ends stuck, the next begins again from the input.
#[derive(Clone, Copy, Debug)]
pub(super) enum Plan {
    /// Trial displacements with an objective that is tried first, and a choice of the side of a path that is its
    /// inside.
    Resolve { objective: Objective, inside: InsideChoice },
    /// The flattening flow, and shape recovery after it.
    Flatten,
}

/// Islands with more edge-face intersections than this are flattened first: a displacement with so many constraints
/// takes minutes, and they contradict each other anyway.
const MAX_FOR_TRIALS: usize = 2500;

/// Whether an island of so many edge-face intersections is flattened first.
pub(super) fn is_beyond_trials(num_edge_face: usize) -> bool {
    num_edge_face > MAX_FOR_TRIALS
}

/// Iterations of tangles larger than this take seconds, and where trials can resolve them they help from the first
/// iteration on.
const LARGE: usize = 500;

/// The plans in order. `largest` is the number of edge-face intersections of the island that has most.
pub(super) fn plans(largest: usize) -> [Plan; 5] {
    let resolve = |objective, inside| Plan::Resolve { objective, inside };
    let normal = resolve(Objective::Normal, InsideChoice::Work);
    let target = resolve(Objective::Target, InsideChoice::Work);
    let [a, b, c] = if is_beyond_trials(largest) {
        [Plan::Flatten, normal, target]
    } else if largest > LARGE {
        [normal, Plan::Flatten, target]
    } else {
        [normal, target, Plan::Flatten]
    };
    [a, b, c, resolve(Objective::Normal, InsideChoice::Count), resolve(Objective::Target, InsideChoice::Count)]
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
    pub(super) fn with(largest: usize) -> Self {
        if largest > LARGE {
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
        let place = |largest| plans(largest).iter().position(|plan| matches!(plan, Plan::Flatten));
        assert_eq!([10, LARGE + 1, MAX_FOR_TRIALS + 1].map(place), [Some(2), Some(1), Some(0)]);
    }

    #[test]
    fn stall_criterion_with_slow_progress_is_met_after_its_window() {
        let stall = StallCriterion::with(10);
        let slow = [8.0, 7.9, 7.8, 7.7, 7.6, 7.5, 7.4];
        assert!(!stall.is_met(&slow[..6]) && stall.is_met(&slow));
        let fast = [8.0, 7.0, 6.0, 5.0, 4.0, 3.0, 2.0];
        assert!(!stall.is_met(&fast));
    }
}
