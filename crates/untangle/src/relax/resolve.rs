//! Iterations of trial displacements: analyse, try several, keep for each island of paths the one that helps most.

use super::{
    constraints::{ConstraintSource, Objective, collect, collect_undecided},
    outcome::{BestState, End, Method, RelaxError},
    plan::{Pace, StallCriterion, trials},
    relaxer::{Progress, Relaxer},
    settings::{Effort, StopObserver},
    sides::SideRows,
    step::{TrialSettings, least_tangled, mark_passing, total},
};
use crate::geometry::mean_edge_length;

/// Width of the k-ring round the constraints that may move.
const DOMAIN_RINGS: usize = 14;
/// The part of the rest shape in the edges that are kept, from the second iteration on.
const REST_WEIGHT: f64 = 0.3;
/// Gap that is to be left between cloth and bodies, in edge lengths of the cloth.
const SIDE_GAP: f64 = 0.2;

/// Iterates from the present state until nothing intersects any more, or nothing helps any more. Paths with targets are
/// resolved for one objective first, and for the others where that does not help.
pub(super) fn resolve(
    relaxer: &mut Relaxer<'_>,
    objective: Objective,
    pace: Pace,
    stall: StallCriterion,
    best: &mut BestState,
    progress: &mut Progress<'_>,
) -> Result<End, RelaxError> {
    // The least merits up to each iteration.
    let mut merits: Vec<f64> = Vec::new();
    let mut widen = false;
    let effort = if pace == Pace::Quick { Effort::Fast } else { relaxer.settings.effort };
    for iteration in 0.. {
        relaxer.measure_islands(2 * DOMAIN_RINGS);
        let merit = total(&relaxer.now).merit();
        if merit < best.merit {
            *best = BestState { merit, positions: relaxer.frame.positions().to_vec() };
        }
        if relaxer.is_clean() {
            return Ok(End::Clean);
        }
        let before = merits.last().copied().unwrap_or(f64::INFINITY);
        merits.push(merit.min(before));
        if relaxer.is_exhausted() {
            return Ok(End::Exhausted);
        }
        if stall.is_met(&merits) {
            break;
        }
        let worse = merit >= before;
        let settings = trials(objective, effort, widen || worse);
        let rest_weight = if iteration == 0 { 0.0 } else { REST_WEIGHT };
        let Some((method, stuck)) = iterate(relaxer, &settings, rest_weight, worse)? else {
            return Ok(End::Interrupted);
        };
        widen = stuck;
        if relaxer.report(method, progress).is_break() {
            return Ok(End::Interrupted);
        }
    }
    Ok(End::Stuck)
}

/// Runs the trials of one iteration and takes the best of them, island by island. Returns the method that helped most,
/// and whether some island did not move; nothing where the work is to stop.
fn iterate(
    relaxer: &mut Relaxer<'_>,
    settings: &[TrialSettings],
    rest_weight: f64,
    must_change: bool,
) -> Result<Option<(Method, bool)>, RelaxError> {
    prepare(relaxer, settings);
    if !(relaxer.should_stop)() {
        relaxer.run_trials(settings, rest_weight);
    }
    // What was cut short is not taken.
    if (relaxer.should_stop)() {
        return Ok(None);
    }
    let (trials, now) = (&relaxer.trials[..settings.len()], &relaxer.now);
    let (choice, positions) = relaxer.choose(|group| least_tangled(trials, now, group, must_change));
    let stuck = choice.iter().zip(now).any(|(choice, now)| choice.is_none() && !now.is_none());
    let method = method_of(relaxer, settings, &choice);
    relaxer.set_frame(&positions)?;
    Ok(Some((method, stuck)))
}

/// Collects the constraints of all trials, and the domain that they move.
fn prepare(relaxer: &mut Relaxer<'_>, settings: &[TrialSettings]) {
    relaxer.resize_trials(settings.len());
    let Relaxer { mesh, frame, analyser, analysis_settings, sides, .. } = relaxer;
    let analysis = analyser.last();
    let found =
        relaxer.correspondent.find(mesh, frame, analysis, analysis_settings, &mut StopObserver(relaxer.should_stop));
    let source = ConstraintSource { mesh, frame, analysis, found, orientation: &relaxer.orientation };
    let trials = &mut relaxer.trials[..settings.len()];
    for (trial, settings) in trials.iter_mut().zip(settings) {
        if let Some(sides) = &*sides {
            let is_decided = |faces| sides.decides(mesh, faces);
            collect_undecided(&mut trial.constraints, &source, settings.objective, is_decided);
        } else {
            collect(&mut trial.constraints, &source, settings.objective);
        }
    }
    let mut rows = SideRows::default();
    if let Some(sides) = sides {
        sides.look(frame);
        rows.find(sides, mesh, frame, &analysis.intersections);
    }
    let seeds = trials.iter().flat_map(|trial| trial.constraints.vertices()).chain(rows.vertices());
    relaxer.domain.grow(mesh, seeds, DOMAIN_RINGS);
    if let Some(sides) = sides {
        rows.find_near(sides, mesh, frame, &relaxer.domain);
        trials.iter_mut().for_each(|trial| rows.add(SIDE_GAP, &mut trial.constraints));
    }
    mark_passing(mesh, analysis, &mut relaxer.passing);
    relaxer.edge_length_m =
        mean_edge_length(mesh, frame, analysis.paths.segments.iter().map(|segment| segment.own)).unwrap_or(0.0);
}

/// The method of the objective that took away most of the tangle.
fn method_of(relaxer: &Relaxer<'_>, settings: &[TrialSettings], choice: &[Option<usize>]) -> Method {
    const METHODS: [(Objective, Method); 3] =
        [(Objective::Normal, Method::Push), (Objective::Target, Method::Rbf), (Objective::Shorten, Method::Contour)];
    let mut gains = [0.0; METHODS.len()];
    for (island, index) in choice.iter().enumerate() {
        if let Some(index) = *index {
            let gain = relaxer.now[island].merit() - relaxer.trials[index].best.tangles[island].merit();
            let is_own = |(objective, _): &(Objective, Method)| *objective == settings[index].objective;
            if let Some(method) = METHODS.iter().position(is_own) {
                gains[method] += gain;
            }
        }
    }
    let most = (1..gains.len()).fold(0, |best, method| if gains[method] > gains[best] { method } else { best });
    METHODS[most].1
}
