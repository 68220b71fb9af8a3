//! All runs of all setups, and their means.

use std::{error::Error, time::Duration};

use super::{
    run::{Run, Scene, run},
    setup::{Setup, Variant},
    targets::{self, TargetErrors},
};

/// How much is measured.
#[derive(Clone, Debug)]
pub(crate) struct Plan {
    /// Scenes, in groups of one name with different seeds.
    pub(crate) scenes: Vec<Scene>,
    /// Edge lengths of the sheets on which targets are measured.
    pub(crate) target_edges_m: Vec<f64>,
    /// Most frames of a run.
    pub(crate) limit: usize,
    /// Times that everything is done; the least of the times counts.
    pub(crate) repeats: usize,
}

/// Figures of a number of runs. Means, but for the residuals, which are the worst.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Figures {
    pub(crate) num_runs: usize,
    /// Runs that were not clean within the limit.
    pub(crate) num_tangled: usize,
    /// Of a frame that is not clean, whether the host asked or not.
    pub(crate) ms_per_frame: f64,
    /// Of an answer.
    pub(crate) ms_per_answer: f64,
    /// To the first clean frame that stays so; a run that was not clean counts with the limit.
    pub(crate) frames: f64,
    pub(crate) remaining: f64,
    pub(crate) distortion: f64,
    pub(crate) residuals: [f64; 2],
}

/// One variant measured.
#[derive(Clone, Debug)]
pub(crate) struct Measured {
    pub(crate) variant: Variant,
    pub(crate) scenes: Vec<(String, Figures)>,
    pub(crate) all: Figures,
    /// Nothing where the response has no targets.
    pub(crate) targets: Option<TargetErrors>,
}

impl Measured {
    /// What the front is about: time of a frame, frames to clean, what remains, and how far targets are off; smaller is
    /// better in all.
    pub(crate) fn costs(&self) -> [f64; 4] {
        let Figures { ms_per_frame, frames, remaining, .. } = self.all;
        [ms_per_frame, frames, remaining, self.targets.map_or(f64::INFINITY, |errors| errors.mean)]
    }

    /// Whether the host asks for every frame: all other factors are then the session's choice.
    pub(crate) fn asks_always(&self) -> bool {
        self.variant.setup.every == 1
    }
}

/// Measures variants; those that are the same setup get the same figures.
///
/// # Errors
/// A scene that is no cloth; a run that was not the same as before.
pub(crate) fn measure(plan: &Plan, variants: &[Variant]) -> Result<Vec<Measured>, Box<dyn Error>> {
    let mut setups: Vec<&Setup> = Vec::new();
    for variant in variants {
        if !setups.contains(&&variant.setup) {
            setups.push(&variant.setup);
        }
    }
    let runs = run_all(plan, &setups)?;
    let mut errors: Vec<(Setup, Option<TargetErrors>)> = Vec::new();
    for setup in &setups {
        let of_one_frame = of_one_frame(setup);
        if !errors.iter().any(|(known, _)| *known == of_one_frame) {
            let found = targets::measure(&of_one_frame, &plan.target_edges_m)?;
            errors.push((of_one_frame, found));
        }
    }
    let measured = |variant: &Variant| {
        let index = setups.iter().position(|&setup| *setup == variant.setup)?;
        let runs: Vec<(&Scene, Run)> = plan.scenes.iter().zip(runs[index].iter().copied()).collect();
        let scenes = runs.chunk_by(|a, b| a.0.name == b.0.name);
        Some(Measured {
            variant: variant.clone(),
            scenes: scenes.map(|runs| (runs[0].0.name.clone(), figures(runs, plan.limit))).collect(),
            all: figures(&runs, plan.limit),
            targets: errors.iter().find(|(known, _)| *known == of_one_frame(setups[index]))?.1,
        })
    };
    Ok(variants.iter().filter_map(measured).collect())
}

/// The runs of each setup on each scene; of the times of repeated runs the least.
fn run_all(plan: &Plan, setups: &[&Setup]) -> Result<Vec<Vec<Run>>, Box<dyn Error>> {
    // One thread, so that its processor time is all the time there is.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    let mut runs: Vec<Vec<Run>> = vec![Vec::new(); setups.len()];
    // The repetitions of a run lie far apart, so that no spell of a busy machine meets all of them.
    for repeat in 0..plan.repeats {
        for (index, (setup, runs)) in setups.iter().zip(&mut runs).enumerate() {
            eprint!("\r{} of {}, {} of {} ", repeat + 1, plan.repeats, index + 1, setups.len());
            for (place, scene) in plan.scenes.iter().enumerate() {
                let again = pool.install(|| run(scene, setup, plan.limit)).map_err(|error| error as Box<dyn Error>)?;
                match runs.get_mut(place) {
                    None => runs.push(again),
                    Some(before) => {
                        let time = before.time.min(again.time);
                        before.time = again.time;
                        if format!("{before:?}") != format!("{again:?}") {
                            return Err(format!("{}: {before:?}, and then {again:?}", scene.name).into());
                        }
                        before.time = time;
                    }
                }
            }
        }
    }
    eprintln!();
    Ok(runs)
}

/// The part of a setup that one frame's targets depend on.
fn of_one_frame(setup: &Setup) -> Setup {
    let Setup { every, between, max_pairs, .. } = Setup::default();
    Setup { every, between, max_pairs, ..setup.clone() }
}

fn figures(runs: &[(&Scene, Run)], limit: usize) -> Figures {
    let mean = |value: &dyn Fn(&Run) -> f64| runs.iter().map(|(_, run)| value(run)).sum::<f64>() / runs.len() as f64;
    let worst = |which: usize| runs.iter().map(|(_, run)| run.residuals[which]).fold(0.0, f64::max);
    let ms = |time: Duration, count: usize| 1e3 * time.as_secs_f64() / count.max(1) as f64;
    Figures {
        num_runs: runs.len(),
        num_tangled: runs.iter().filter(|(_, run)| run.clean_at.is_none()).count(),
        ms_per_frame: mean(&|run| ms(run.time, run.tangled_frames)),
        ms_per_answer: mean(&|run| ms(run.time, run.answers)),
        frames: mean(&|run| run.clean_at.unwrap_or(limit) as f64),
        remaining: mean(&|run| run.remaining as f64),
        distortion: mean(&|run| run.distortion),
        residuals: [worst(0), worst(1)],
    }
}
