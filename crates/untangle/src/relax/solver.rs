//! The whole relaxation: one plan after the other until one ends clean, then shape recovery.

use std::ops::ControlFlow;

use nalgebra::Point3;

use super::{
    alternatives::{
        CleanEnd, LayeredAttempt, are_allowed, attempt_in_implied_order, end_from_coarser, is_far, is_near, take,
        take_if_nearer, take_least, take_led_back,
    },
    attempt::attempt,
    escape::DescentVariant,
    flattening::flatten,
    input::analyse_input,
    multilevel::CoarserMesh,
    outcome::{BestState, End, Iteration, RelaxError, Solution},
    plan::{Largest, Plan, StallCriterion, plans, plans_without_paths},
    relaxer::{Progress, Relaxer},
    resolve::resolve,
    settings::{RelaxSettings, ShouldStop},
    settle::settle,
    step::total,
};
use crate::mesh::Mesh;

/// A tangle of less than this part of another is far less.
const FAR_LESS: f64 = 0.1;

/// The most levels of coarser meshes: with half of the vertices each, edges are up to eight times as long.
const MAX_LEVELS: usize = 6;

/// Which mesh of a hierarchy is solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Level {
    Given,
    /// A coarser one, which begins from one that is coarser still, so many times. What comes apart there by
    /// straightening only says nothing of the finer one.
    Coarser {
        num_below: usize,
    },
}

impl Level {
    /// Whether more is tried than an attempt and others beside it: on the given mesh, and on the coarsest of a chain,
    /// where it costs little.
    fn is_to_be_planned(self) -> bool {
        matches!(self, Self::Given | Self::Coarser { num_below: 0 })
    }
}

/// The best state that is found from an input, its shape recovered.
pub(super) fn solve(
    mesh: &Mesh,
    positions: &[[f64; 3]],
    settings: &RelaxSettings,
    progress: &mut Progress<'_>,
    should_stop: &ShouldStop<'_>,
) -> Result<Solution, RelaxError> {
    solve_level(Level::Given, mesh, positions, settings, progress, should_stop)
}

fn solve_level(
    level: Level,
    mesh: &Mesh,
    positions: &[[f64; 3]],
    settings: &RelaxSettings,
    progress: &mut Progress<'_>,
    should_stop: &ShouldStop<'_>,
) -> Result<Solution, RelaxError> {
    let mut relaxer = Relaxer::new(mesh, positions, settings, should_stop)?;
    let input = relaxer.frame.positions().to_vec();
    let mut best = BestState { merit: f64::INFINITY, positions: input };
    let largest = analyse_input(&mut relaxer);
    let layered = match level {
        Level::Given => attempt_in_implied_order(&relaxer, largest, progress)?,
        Level::Coarser { .. } => LayeredAttempt::Nothing,
    };
    let layered = match layered {
        LayeredAttempt::Nothing => None,
        LayeredAttempt::Clean(layered) if layered.is_enough() => {
            take(&mut relaxer, layered.into_end())?;
            return Ok(relaxer.into_solution(End::Clean, largest, false));
        }
        LayeredAttempt::Clean(layered) => Some(layered),
        LayeredAttempt::Interrupted(best, history) => {
            relaxer.set_frame(&best.positions)?;
            relaxer.history = history;
            return Ok(relaxer.into_solution(End::Interrupted, largest, true));
        }
    };
    let (mut end, mut is_taken) = attempts(level, &mut relaxer, largest, &mut best, progress)?;
    if end == End::Stuck && level.is_to_be_planned() {
        (end, is_taken) = run_plans(level, &mut relaxer, largest, &mut best, progress)?;
    }
    relaxer.set_frame(&best.positions)?;
    let mut interrupted = end == End::Interrupted;
    if !relaxer.history.is_empty() && !interrupted {
        interrupted = settle(&mut relaxer, progress)?;
        let is_to_compete = end == End::Clean && !is_taken && are_allowed(&relaxer, largest);
        if !interrupted && is_to_compete && is_far(&relaxer, largest) {
            take_least(&mut relaxer, largest, true)?;
            interrupted = should_stop();
        }
    }
    if let Some(layered) = layered
        && take_if_nearer(&mut relaxer, layered, end == End::Clean)?
    {
        end = End::Clean;
    }
    Ok(relaxer.into_solution(end, largest, interrupted))
}

/// The end that coarser meshes lead to: of several levels that begin from the coarsest, the coarsest first, the first
/// end that is near the input, or else the one that moves the mean vertex least.
fn end_by_coarser(relaxer: &Relaxer<'_>, largest: Largest) -> Result<Option<CleanEnd>, RelaxError> {
    let mut least: Option<CleanEnd> = None;
    for num_below in (0..MAX_LEVELS).rev() {
        if let Some(end) = end_from_level(relaxer, largest, num_below)? {
            if is_near(&end) {
                return Ok(Some(end));
            }
            least = Some(end).into_iter().chain(least).min_by(|a, b| a.mean().total_cmp(&b.mean()));
        }
    }
    Ok(least)
}

/// The end that a coarser mesh with so many below it leads to, if that is clean.
fn end_from_level(relaxer: &Relaxer<'_>, largest: Largest, num_below: usize) -> Result<Option<CleanEnd>, RelaxError> {
    match state_of_coarser(relaxer, num_below)? {
        Some(state) => end_from_coarser(relaxer, largest, &state),
        None => Ok(None),
    }
}

/// Where the vertices are after a coarser mesh of the input came apart; nothing where there is none, or not so many
/// below it, or nothing intersects in it, or it does not come apart. Deep tangles are fewer edges deep there, and cost
/// less.
///
/// Cost: that of an attempt on half of the vertices, and on each of those below it.
fn state_of_coarser(relaxer: &Relaxer<'_>, num_below: usize) -> Result<Option<Vec<Point3<f64>>>, RelaxError> {
    let Relaxer { mesh, settings, rest, should_stop, .. } = relaxer;
    let Some(coarser) = CoarserMesh::of(mesh, rest.positions()) else { return Ok(None) };
    let settings = RelaxSettings { single_precision: false, ..(*settings).clone() };
    let mut progress = |_: &Iteration| ControlFlow::Continue(());
    let found = solve_level(
        Level::Coarser { num_below },
        &coarser.mesh,
        &coarser.positions,
        &settings,
        &mut progress,
        *should_stop,
    )?;
    let helps = found.end == End::Clean && !found.history.is_empty() && !found.interrupted;
    Ok(helps.then(|| coarser.prolonged(rest.positions(), &found.positions)))
}

/// The first attempt, and the others where that leaves little, or on the coarsest mesh of a chain, where they cost
/// little. How it ended, and whether other ends were looked at. A coarser mesh that is not the coarsest begins from the
/// one below it, and has no others.
fn attempts(
    level: Level,
    relaxer: &mut Relaxer<'_>,
    largest: Largest,
    best: &mut BestState,
    progress: &mut Progress<'_>,
) -> Result<(End, bool), RelaxError> {
    if largest.is_crowded() && relaxer.sides.is_none() {
        return Ok((End::Stuck, false));
    }
    if let Level::Coarser { num_below: num_below @ 1.. } = level {
        let Some(end) = end_from_level(relaxer, largest, num_below - 1)? else { return Ok((End::Stuck, false)) };
        take(relaxer, end)?;
        return Ok((keep(relaxer, best), true));
    }
    let tangle = total(&relaxer.now).merit();
    let end = attempt(relaxer, largest.num_edge_face, DescentVariant::FIRST, best, progress)?;
    let is_promising = level != Level::Given || best.merit < FAR_LESS * tangle;
    if end == End::Stuck && is_promising && are_allowed(relaxer, largest) {
        relaxer.set_frame(&best.positions)?;
        if take_least(relaxer, largest, false)? {
            return Ok((keep(relaxer, best), true));
        }
    }
    Ok((end, false))
}

/// Makes the present state, a clean one, the best.
fn keep(relaxer: &Relaxer<'_>, best: &mut BestState) -> End {
    *best = BestState { merit: 0.0, positions: relaxer.frame.positions().to_vec() };
    End::Clean
}

/// One plan from the input after the other, until one does not end stuck, and coarser meshes before anything is
/// flattened. How the last one ended, and whether that was of coarser meshes.
fn run_plans(
    level: Level,
    relaxer: &mut Relaxer<'_>,
    largest: Largest,
    best: &mut BestState,
    progress: &mut Progress<'_>,
) -> Result<(End, bool), RelaxError> {
    let input = relaxer.rest.positions().to_vec();
    let plans = if relaxer.is_on_wrong_side_only() { plans_without_paths() } else { plans(largest) };
    let mut end = End::Stuck;
    for plan in plans {
        if let Plan::Resolve { inside, .. } = plan {
            relaxer.analysis_settings.inside = inside;
        }
        relaxer.set_frame(&input)?;
        end = match plan {
            Plan::Resolve { objective, pace, .. } => {
                let stall = StallCriterion::with(largest.num_edge_face, pace);
                resolve(relaxer, objective, pace, stall, best, progress)?
            }
            Plan::Flatten if level != Level::Given => End::Stuck,
            Plan::Flatten => {
                if are_allowed(relaxer, largest)
                    && !largest.has_many_paths()
                    && let Some(end) = end_by_coarser(relaxer, largest)?
                {
                    take_led_back(relaxer, largest, end)?;
                    return Ok((keep(relaxer, best), true));
                }
                flatten_if_it_pays(relaxer, best, progress)?
            }
        };
        if end != End::Stuck {
            break;
        }
    }
    Ok((end, false))
}

/// Flattening moves everything. What it leaves is kept only where it is clean, or far less tangled than the best state
/// that is nearer to the input.
fn flatten_if_it_pays(
    relaxer: &mut Relaxer<'_>,
    best: &mut BestState,
    progress: &mut Progress<'_>,
) -> Result<End, RelaxError> {
    let mut flattened = BestState { merit: best.merit, positions: best.positions.clone() };
    let end = flatten(relaxer, &mut flattened, progress)?;
    if end == End::Clean || flattened.merit < FAR_LESS * best.merit {
        *best = flattened;
    }
    Ok(end)
}

#[cfg(test)]
mod tests;
