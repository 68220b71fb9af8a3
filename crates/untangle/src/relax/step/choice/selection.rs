//! The best of several trials, for one group of islands.

use nalgebra::Point3;

use super::groups::{Groups, Seams};
use crate::relax::step::{tangle::Tangle, trial::Trial};

/// Strains beyond this logarithm count against a state that still intersects: what is crushed now blocks the next
/// displacement.
const LARGE_STRAIN: f64 = 0.25;

/// The trial that leaves a group of islands least tangled, and of those that leave it clean the one with the least
/// strain. Nothing if none is better than no step, unless something must change.
pub(crate) fn least_tangled(trials: &[Trial], now: &[Tangle], group: &[usize], must_change: bool) -> Option<usize> {
    let is_clean = |tangles: &[Tangle]| group.iter().all(|&island| tangles[island].is_none());
    let must_change = must_change && !is_clean(now);
    let mut best = (if must_change { f64::INFINITY } else { merit(now, group) }, f64::INFINITY, None);
    for (index, trial) in trials.iter().enumerate().filter(|(_, trial)| trial.is_usable) {
        let strain = largest(&trial.best.strains, group);
        let merit = merit(&trial.best.tangles, group) * (1.0 + (strain - LARGE_STRAIN).max(0.0));
        let calmer = best.2.is_some() && is_clean(&trial.best.tangles) && strain < best.1;
        if merit < best.0 || (merit <= best.0 && calmer) {
            best = (merit, strain, Some(index));
        }
    }
    best.2
}

/// Chooses a trial for each group of islands, and joins groups that would tear the cloth between them. Gives back the
/// choice for each island, and for what lies near none, and where it leads.
pub(crate) fn choose_together(
    seams: &Seams<'_>,
    trials: &[Trial],
    choose: impl Fn(&[usize]) -> Option<usize>,
) -> (Vec<Option<usize>>, Vec<Point3<f64>>) {
    let num_islands = seams.islands.len() + 1;
    let mut groups = Groups::of_single_islands(num_islands);
    let mut choice = vec![None; num_islands];
    loop {
        for group in groups.members() {
            let chosen = choose(&group);
            for island in group {
                choice[island] = chosen;
            }
        }
        let positions = positions_of(seams, trials, &choice);
        if !groups.join_torn(seams, &positions) {
            return (choice, positions);
        }
    }
}

/// The positions before the step, with each island moved by the trial that was chosen for it.
fn positions_of(seams: &Seams<'_>, trials: &[Trial], choice: &[Option<usize>]) -> Vec<Point3<f64>> {
    let mut positions = seams.before.to_vec();
    for &vertex in seams.domain.vertices() {
        if let Some(index) = choice[seams.islands.of(vertex)] {
            positions[vertex.index()] = trials[index].best.positions[vertex.index()];
        }
    }
    positions
}

fn merit(tangles: &[Tangle], group: &[usize]) -> f64 {
    group.iter().map(|&island| tangles[island].merit()).sum()
}

fn largest(strains: &[f64], group: &[usize]) -> f64 {
    group.iter().map(|&island| strains[island]).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A trial that leaves so many intersections, with so much strain.
    fn trial(num_edge_face: usize, strain: f64) -> Trial {
        let mut trial = Trial::default();
        trial.is_usable = true;
        trial.best.tangles = vec![Tangle { num_edge_face, ..Tangle::default() }];
        trial.best.strains = vec![strain];
        trial
    }

    #[test]
    fn least_tangled_of_clean_trials_is_the_least_strained() {
        let now = [Tangle { num_edge_face: 4, ..Tangle::default() }];
        let mut trials = [trial(2, 0.0), trial(0, 0.3), trial(0, 0.1), trial(0, 0.2)];
        assert_eq!(least_tangled(&trials, &now, &[0], false), Some(2));
        trials[2].is_usable = false;
        assert_eq!(least_tangled(&trials, &now, &[0], false), Some(3));
    }

    #[test]
    fn least_tangled_without_better_trial_is_none_unless_something_must_change() {
        let now = [Tangle { num_edge_face: 4, ..Tangle::default() }];
        let trials = [trial(9, 0.0), trial(5, 0.0)];
        assert_eq!(least_tangled(&trials, &now, &[0], false), None);
        assert_eq!(least_tangled(&trials, &now, &[0], true), Some(1));
    }
}
