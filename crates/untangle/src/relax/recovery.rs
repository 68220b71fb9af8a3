//! Shape recovery: steps towards the rest shape of what intersects nothing any more.

use nalgebra::Point3;

use super::{
    constraints::Objective,
    outcome::{Method, RelaxError},
    plan::MAX_STRETCH,
    relaxer::{Progress, Relaxer},
    step::{CollisionFreeStep, TrialSettings, island_strains, least_strained, measure, num_movable, total},
};
use crate::mesh::VertexId;

/// The most steps.
const MAX_STEPS: usize = 4;
/// Width of the k-ring that may move, round the vertices that are away from their rest positions.
const RECOVERED_RINGS: usize = 2;
/// Gap that is kept where sheets were separated, in mean edge lengths.
const GAP: f64 = 0.2;
/// Strains below this logarithm are left alone.
const SMALL_STRAIN: f64 = 0.05;
/// Stiffnesses of the trials.
const STIFFNESSES: [f64; 2] = [16.0, 256.0];

/// Recovers some of the input's shape where the present state is clean, with all separation constraints held. Islands
/// that are still tangled stay as they are. True if `progress` ended it.
pub(super) fn recover_shape(relaxer: &mut Relaxer<'_>, progress: &mut Progress<'_>) -> Result<bool, RelaxError> {
    relaxer.islands.clone_from(&relaxer.first_islands);
    let Relaxer { mesh, frame, analyser, sides, islands, now, .. } = relaxer;
    measure(mesh, frame, &analyser.last().intersections, sides.as_ref(), islands, now);
    relaxer.passing.reset(relaxer.mesh.num_vertices());
    for _ in 0..MAX_STEPS {
        if !step(relaxer)? {
            return Ok((relaxer.should_stop)());
        }
        if relaxer.report(Method::RecoverShape, progress).is_break() {
            return Ok(true);
        }
    }
    Ok(false)
}

/// One step. False if none was possible, or needed.
fn step(relaxer: &mut Relaxer<'_>) -> Result<bool, RelaxError> {
    let Relaxer { mesh, frame, rest, domain, islands, limits, .. } = relaxer;
    let moved = mesh.vertex_ids().filter(|&vertex| rest.position(vertex) != frame.position(vertex));
    domain.grow(mesh, moved, RECOVERED_RINGS);
    let mut strains = Vec::new();
    island_strains(mesh, domain, islands, limits, frame.positions(), &mut strains);
    if strains.iter().all(|&strain| strain < SMALL_STRAIN) {
        return Ok(false);
    }
    let settings = STIFFNESSES.map(|stiffness| TrialSettings {
        objective: Objective::Normal,
        stiffness,
        max_stretch: MAX_STRETCH,
    });
    relaxer.resize_trials(settings.len());
    let gap_m = GAP * relaxer.edge_length_m;
    let near = relaxer.rows_near_bodies();
    for trial in &mut relaxer.trials[..settings.len()] {
        trial.constraints.clear();
        trial.constraints.hold(&relaxer.separated, &relaxer.frame);
        trial.constraints.limit_to_gap(&relaxer.frame, gap_m);
        near.add(GAP, &mut trial.constraints);
    }
    relaxer.run_trials(&settings, 1.0);
    if (relaxer.should_stop)() {
        return Ok(false);
    }
    let trials = &relaxer.trials[..settings.len()];
    let (choice, positions) = relaxer.choose(|group| least_strained(trials, &strains, group));
    if choice.iter().all(Option::is_none) {
        return Ok(false);
    }
    let before = relaxer.frame.positions().to_vec();
    let now = total(&relaxer.now);
    relaxer.set_frame(&positions)?;
    let num_left = num_movable(relaxer.mesh, &relaxer.analyser.last().intersections);
    if num_left <= now.num_edge_face && relaxer.wrong_vertices().len() <= now.num_wrong {
        return Ok(true);
    }
    // Islands that moved differently met at their borders.
    relaxer.set_frame(&before)?;
    step_back(relaxer, &positions)
}

/// Goes towards `target` as far as nothing intersects on the way. False if nothing moves, or edges get overstretched.
fn step_back(relaxer: &mut Relaxer<'_>, target: &[Point3<f64>]) -> Result<bool, RelaxError> {
    let Relaxer { mesh, settings, frame, domain, limits, sides, should_stop, .. } = &*relaxer;
    let mut positions = frame.positions().to_vec();
    let mut step = CollisionFreeStep::new(mesh, domain, *should_stop);
    let moves = step.advance(&mut positions, target, settings.single_precision, sides.as_ref());
    let is_torn = |&vertex: &VertexId| limits.is_violated(mesh, frame.positions(), &positions, vertex);
    if !moves || domain.vertices().iter().any(is_torn) {
        return Ok(false);
    }
    relaxer.set_frame(&positions)?;
    Ok(true)
}
