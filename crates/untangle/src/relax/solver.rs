//! The whole relaxation: one plan after the other until one ends clean, then shape recovery.

use nalgebra::Point3;

use super::{
    constraints::Objective,
    escape::descend,
    flattening::flatten,
    nudge::nudge,
    outcome::{BestState, End, RelaxError, Relaxation, blocked_paths},
    plan::{
        Largest, Pace, Plan, StallCriterion, are_copies_in_one_place, is_beyond_trials, plans, plans_without_paths,
    },
    relaxer::{Progress, Relaxer},
    resolve::resolve,
    settings::{RelaxSettings, ShouldStop},
    settle::settle,
    step::are_faces_pinned,
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

/// See [`relax`](super::relax).
pub(super) fn run(
    mesh: &Mesh,
    positions: &[[f64; 3]],
    settings: &RelaxSettings,
    progress: &mut Progress<'_>,
    should_stop: &ShouldStop<'_>,
) -> Result<Relaxation, RelaxError> {
    let mut relaxer = Relaxer::new(mesh, positions, settings, should_stop)?;
    let input = relaxer.frame.positions().to_vec();
    let mut best = BestState { merit: f64::INFINITY, positions: input.clone() };
    let largest = analyse_input(&mut relaxer);
    let mut end = escape(&mut relaxer, largest, &mut best, progress)?;
    let plans = match end {
        End::Stuck if relaxer.is_on_wrong_side_only() => plans_without_paths(),
        End::Stuck => plans(largest),
        _ => Vec::new(),
    };
    for plan in plans {
        if let Plan::Resolve { inside, .. } = plan {
            relaxer.analysis_settings.inside = inside;
        }
        relaxer.set_frame(&input)?;
        end = match plan {
            Plan::Resolve { objective, pace, .. } => {
                let stall = StallCriterion::with(largest.num_edge_face, pace);
                resolve(&mut relaxer, objective, pace, stall, &mut best, progress)?
            }
            Plan::Flatten => flatten_if_it_pays(&mut relaxer, &mut best, progress)?,
        };
        if end != End::Stuck {
            break;
        }
    }
    relaxer.set_frame(&best.positions)?;
    let mut interrupted = end == End::Interrupted;
    if !relaxer.history.is_empty() && !interrupted {
        interrupted = settle(&mut relaxer, progress)?;
        relaxer.analyse();
    }
    let blocked = blocked_paths(mesh, &relaxer.final_paths(), end, largest.is_crowded());
    let restored = |(point, (before, given)): (&Point3<f64>, (&Point3<f64>, &[f64; 3]))| {
        // A frame takes the smallest values as zero.
        if point == before { *given } else { (*point).into() }
    };
    let positions = relaxer.frame.positions().iter().zip(input.iter().zip(positions)).map(restored).collect();
    Ok(Relaxation { positions, history: relaxer.history, blocked, interrupted })
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

/// Whether most of what intersects meets pinned faces: a body that stays. The shortest motion out of it may lead
/// through it, while the regions of the paths show on which side the cloth belongs. A mesh with bodies knows
/// that of them.
fn is_against_pins(relaxer: &Relaxer<'_>) -> bool {
    if relaxer.sides.is_some() {
        return false;
    }
    let segments = &relaxer.analyser.last().intersections.segments;
    let meets_pins = |segment: &&Segment| segment.faces.iter().any(|&face| are_faces_pinned(relaxer.mesh, [face]));
    2 * segments.iter().filter(meets_pins).count() > segments.len()
}

/// The nearest plan: a descent by local motions, and trials from where it ends stuck. Against a body that stays trials
/// come first.
fn escape(
    relaxer: &mut Relaxer<'_>,
    largest: Largest,
    best: &mut BestState,
    progress: &mut Progress<'_>,
) -> Result<End, RelaxError> {
    if largest.is_crowded() && relaxer.sides.is_none() {
        return Ok(End::Stuck);
    }
    if is_against_pins(relaxer) {
        let input = relaxer.frame.positions().to_vec();
        let stall = StallCriterion::with(largest.num_edge_face, Pace::Usual);
        let end = resolve(relaxer, Objective::Normal, Pace::Usual, stall, best, progress)?;
        if end != End::Stuck {
            return Ok(end);
        }
        relaxer.set_frame(&input)?;
    }
    let mut end = descend(relaxer, best, progress)?;
    if end == End::Stuck && relaxer.sides.is_some() {
        relaxer.set_frame(&best.positions)?;
        if relaxer.hangs_on_pins() {
            // Nothing else waits for it, or goes without recovery.
            return Ok(End::Clean);
        }
    }
    for objective in [Objective::Normal, Objective::Target] {
        if end == End::Stuck {
            relaxer.set_frame(&best.positions)?;
            let stall = StallCriterion::with(largest.num_edge_face, Pace::Usual);
            end = resolve(relaxer, objective, Pace::Usual, stall, best, progress)?;
        }
        if relaxer.is_on_wrong_side_only() {
            return Ok(end);
        }
    }
    if end == End::Stuck { nudge(relaxer, best, progress) } else { Ok(end) }
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
