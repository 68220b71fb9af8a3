//! The whole relaxation: one plan after the other until one ends clean, then shape recovery.

use nalgebra::Point3;

use super::{
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
    let mut end = End::Clean;
    let largest = analyse_input(&mut relaxer);
    for (index, plan) in plans(largest).into_iter().enumerate() {
        if let Plan::Resolve { inside, .. } = plan {
            relaxer.analysis_settings.inside = inside;
        }
        if index > 0 {
            relaxer.separated.clear();
            relaxer.set_frame(&input)?;
        }
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
    if !relaxer.history.is_empty() && !interrupted {
        interrupted = recover_shape(&mut relaxer, progress)?;
    }
    let blocked = blocked_paths(mesh, &relaxer.final_paths(), end);
    let restored = |(point, (before, given)): (&Point3<f64>, (&Point3<f64>, &[f64; 3]))| {
        // A frame takes the smallest values as zero.
        if point == before { *given } else { (*point).into() }
    };
    let positions = relaxer.frame.positions().iter().zip(input.iter().zip(positions)).map(restored).collect();
    Ok(Relaxation { positions, history: relaxer.history, blocked, interrupted })
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
