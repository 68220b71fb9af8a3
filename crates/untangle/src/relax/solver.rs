//! The whole relaxation: one plan after the other until one ends clean, then shape recovery.

use super::{
    constraints::Objective,
    escape::{descend, settle},
    flattening::flatten,
    outcome::{BestState, End, RelaxError, Relaxation, blocked_paths},
    plan::{Plan, StallCriterion, is_beyond_trials, plans},
    recovery::recover_shape,
    relaxer::{Progress, Relaxer},
    resolve::resolve,
    settings::RelaxSettings,
};
use crate::{
    intersect::{Intersections, Intersector},
    mesh::Mesh,
    settings::InsideChoice,
};

/// See [`relax`](super::relax).
pub(super) fn run(
    mesh: &Mesh,
    positions: &[[f64; 3]],
    settings: &RelaxSettings,
    progress: &mut Progress<'_>,
) -> Result<Relaxation, RelaxError> {
    let mut relaxer = Relaxer::new(mesh, positions, settings)?;
    let input = relaxer.frame.positions().to_vec();
    let mut best = BestState { merit: f64::INFINITY, positions: input.clone() };
    let largest = analyse_input(&mut relaxer);
    let mut end = escape(&mut relaxer, largest, &mut best, progress)?;
    let is_near = end == End::Clean;
    let plans = if end == End::Stuck { plans(largest).to_vec() } else { Vec::new() };
    for plan in plans {
        if let Plan::Resolve { inside, .. } = plan {
            relaxer.analysis_settings.inside = inside;
        }
        relaxer.separated.clear();
        relaxer.set_frame(&input)?;
        end = match plan {
            Plan::Resolve { objective, .. } => {
                resolve(&mut relaxer, objective, StallCriterion::with(largest), &mut best, progress)?
            }
            Plan::Flatten => flatten(&mut relaxer, &mut best, progress)?,
        };
        if end != End::Stuck {
            break;
        }
    }
    relaxer.set_frame(&best.positions)?;
    let mut interrupted = end == End::Interrupted;
    if is_near && !relaxer.history.is_empty() {
        interrupted = settle(&mut relaxer, progress)?;
        relaxer.analyse();
    }
    let blocked = blocked_paths(mesh, relaxer.analyser.last(), end);
    if blocked.is_empty() && !relaxer.history.is_empty() && !interrupted {
        interrupted = recover_shape(&mut relaxer, progress)?;
    }
    let positions = relaxer.frame.positions().iter().map(|point| (*point).into()).collect();
    Ok(Relaxation { positions, history: relaxer.history, blocked, interrupted })
}

/// The nearest plan: a descent by local motions, and trials from where it ends stuck.
fn escape(
    relaxer: &mut Relaxer<'_>,
    largest: usize,
    best: &mut BestState,
    progress: &mut Progress<'_>,
) -> Result<End, RelaxError> {
    if is_beyond_trials(largest) {
        return Ok(End::Stuck);
    }
    let mut end = descend(relaxer, best, progress)?;
    for objective in [Objective::Normal, Objective::Target] {
        if end == End::Stuck {
            relaxer.set_frame(&best.positions)?;
            end = resolve(relaxer, objective, StallCriterion::with(largest), best, progress)?;
        }
    }
    Ok(end)
}

/// Analyses the input. Gives back the number of edge-face intersections of the island of paths that has most.
fn analyse_input(relaxer: &mut Relaxer<'_>) -> usize {
    let mut found = Intersections::default();
    Intersector::default().intersect(relaxer.mesh, &relaxer.frame, &mut found);
    let many = is_beyond_trials(found.edge_face.len());
    let wanted = relaxer.analysis_settings.inside;
    if many {
        // The size of the largest island needs no better choice, and of so many paths the others take minutes.
        relaxer.analysis_settings.inside = InsideChoice::Count;
    }
    relaxer.analyse();
    relaxer.measure_islands(0);
    let largest = relaxer.now.iter().map(|tangle| tangle.num_edge_face).max().unwrap_or(0);
    if many && !is_beyond_trials(largest) {
        relaxer.analysis_settings.inside = wanted;
        relaxer.analyse();
    }
    relaxer.first_islands.find(relaxer.mesh, relaxer.analyser.last(), usize::MAX / 2);
    largest
}
