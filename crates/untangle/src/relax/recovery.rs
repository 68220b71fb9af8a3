//! Shape recovery: steps towards the rest shape, once nothing intersects any more.

use super::{
    constraints::Objective,
    outcome::{Method, RelaxError},
    plan::MAX_STRETCH,
    relaxer::{Progress, Relaxer},
    step::{Tangle, TrialSettings, island_strains, least_strained},
};

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

/// Recovers some of the input's shape from a clean state, with all separation constraints held. True if `progress`
/// ended it.
pub(super) fn recover_shape(relaxer: &mut Relaxer<'_>, progress: &mut Progress<'_>) -> Result<bool, RelaxError> {
    relaxer.islands.clone_from(&relaxer.first_islands);
    relaxer.now.clear();
    relaxer.now.resize(relaxer.islands.len() + 1, Tangle::default());
    relaxer.passing.reset(relaxer.mesh.num_vertices());
    for _ in 0..MAX_STEPS {
        if !step(relaxer)? {
            break;
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
    for trial in &mut relaxer.trials[..settings.len()] {
        trial.constraints.clear();
        trial.constraints.hold(&relaxer.separated, &relaxer.frame);
        trial.constraints.limit_to_gap(&relaxer.frame, gap_m);
    }
    relaxer.run_trials(&settings, 1.0);
    let trials = &relaxer.trials[..settings.len()];
    let choice: Vec<Option<usize>> =
        (0..strains.len()).map(|island| least_strained(trials, &strains, island)).collect();
    let before = relaxer.frame.positions().to_vec();
    let positions = relaxer.positions_of(&choice);
    relaxer.set_frame(&positions)?;
    if relaxer.analyser.last().intersections.edge_face.is_empty() {
        return Ok(choice.iter().any(Option::is_some));
    }
    // Islands that moved differently met at their borders.
    relaxer.set_frame(&before)?;
    Ok(false)
}
