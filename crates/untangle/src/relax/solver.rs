//! The whole relaxation: one plan after the other until one ends clean, then shape recovery.

use super::{
    alternatives::{are_allowed, is_far, take_least},
    attempt::attempt,
    escape::DescentVariant,
    flattening::flatten,
    outcome::{BestState, End, RelaxError, Solution},
    plan::{Largest, Plan, StallCriterion, are_copies_in_one_place, is_beyond_trials, plans, plans_without_paths},
    relaxer::{Progress, Relaxer},
    resolve::resolve,
    settings::{RelaxSettings, ShouldStop},
    settle::settle,
    step::total,
};
use crate::{
    analysis::Analysis,
    intersect::{Intersections, Intersector, Segment},
    mesh::Mesh,
    paths::PathPair,
    settings::InsideChoice,
};

/// A tangle of less than this part of another is far less.
const FAR_LESS: f64 = 0.1;

/// The best state that is found from an input, its shape recovered.
pub(super) fn solve(
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
    let (mut end, has_least) = attempts(&mut relaxer, largest, &mut best, progress)?;
    if end == End::Stuck {
        end = run_plans(&mut relaxer, largest, &mut best, progress)?;
    }
    relaxer.set_frame(&best.positions)?;
    let mut interrupted = end == End::Interrupted;
    if !relaxer.history.is_empty() && !interrupted {
        interrupted = settle(&mut relaxer, progress)?;
        let is_to_compete = end == End::Clean && !has_least && are_allowed(&relaxer, largest);
        if !interrupted && is_to_compete && is_far(&relaxer, largest) {
            take_least(&mut relaxer, largest, true)?;
            interrupted = should_stop();
        }
    }
    let positions = relaxer.frame.positions().to_vec();
    Ok(Solution { positions, history: relaxer.history, end, is_crowded: largest.is_crowded(), interrupted })
}

/// The first attempt, and the others where that leaves little. How it ended, and whether that is the least of several
/// ends.
fn attempts(
    relaxer: &mut Relaxer<'_>,
    largest: Largest,
    best: &mut BestState,
    progress: &mut Progress<'_>,
) -> Result<(End, bool), RelaxError> {
    if largest.is_crowded() && relaxer.sides.is_none() {
        return Ok((End::Stuck, false));
    }
    let tangle = total(&relaxer.now).merit();
    let end = attempt(relaxer, largest.num_edge_face, DescentVariant::FIRST, best, progress)?;
    if end == End::Stuck && best.merit < FAR_LESS * tangle && are_allowed(relaxer, largest) {
        relaxer.set_frame(&best.positions)?;
        if take_least(relaxer, largest, false)? {
            *best = BestState { merit: 0.0, positions: relaxer.frame.positions().to_vec() };
            return Ok((End::Clean, true));
        }
    }
    Ok((end, false))
}

/// One plan from the input after the other, until one does not end stuck.
fn run_plans(
    relaxer: &mut Relaxer<'_>,
    largest: Largest,
    best: &mut BestState,
    progress: &mut Progress<'_>,
) -> Result<End, RelaxError> {
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
            Plan::Flatten => flatten_if_it_pays(relaxer, best, progress)?,
        };
        if end != End::Stuck {
            break;
        }
    }
    Ok(end)
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

/// Analyses the input. Gives back what there is to know about the island of paths that has most.
fn analyse_input(relaxer: &mut Relaxer<'_>) -> Largest {
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
    let largest = largest_island(relaxer);
    if many && !largest.is_crowded() {
        relaxer.analysis_settings.inside = wanted;
        relaxer.analyse();
    }
    let positions = relaxer.frame.positions();
    let wrong = relaxer.sides.as_ref().map(|sides| sides.wrong_groups(relaxer.mesh, positions)).unwrap_or_default();
    relaxer.first_islands.find(relaxer.mesh, relaxer.analyser.last(), &wrong, usize::MAX / 2);
    largest
}

/// The island that has most intersections, of those that were measured last.
fn largest_island(relaxer: &Relaxer<'_>) -> Largest {
    let Relaxer { mesh, frame, analyser, islands, now, .. } = relaxer;
    let Analysis { intersections, paths, .. } = analyser.last();
    let island = (0..now.len()).rev().max_by_key(|&island| now[island].num_edge_face).unwrap_or(0);
    let is_here = |pair: &&PathPair| {
        let first = &paths.segments[paths.copies[pair.copies.start].segments.start];
        let face = if mesh.is_body_face(first.own) { first.partner } else { first.own };
        islands.of(mesh.face(face)[0]) == island
    };
    let closed = mesh.closed_pieces();
    let is_flattenable = |segment: &&Segment| {
        let [a, b] = segment.faces.map(|face| mesh.piece(face));
        a == b && a.is_some_and(|piece| !closed[piece.index()])
    };
    let num_flattenable = intersections.segments.iter().filter(is_flattenable).count();
    #[expect(clippy::cast_precision_loss, reason = "counts")]
    let flattenable = num_flattenable as f64 / intersections.segments.len().max(1) as f64;
    Largest {
        num_edge_face: now.get(island).map_or(0, |tangle| tangle.num_edge_face),
        num_pairs: paths.pairs.iter().filter(is_here).count(),
        flattenable,
        is_copy: are_copies_in_one_place(mesh, frame, &intersections.segments),
    }
}
