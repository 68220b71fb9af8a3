//! One run: a tangled scene, simulated with corrections until it is clean.

use std::{error::Error, sync::Arc, time::Duration};

use cpu_time::ThreadTime;
use nalgebra::{Point3, Vector3};
use untangle::{
    frame::Frame,
    respond::Corrections,
    settings::Response,
    stage::{Stage, StageObserver},
    untangler::Untangler,
};
use untangled_checker::count_edge_face;
use untangled_lab::host::{DT_S, Taken, mesh_of};
use untangled_publisher::{
    mesh::{Cloth, to_f32},
    solver::{Parameters, Solver},
};

use super::setup::{Between, Setup, Wire};

/// A scene is clean once it stays so for as many frames more.
pub(crate) const HELD: usize = 5;
/// After as many frames the remaining intersections are counted.
pub(crate) const REMAINING_AFTER: usize = 10;

/// Where a run starts.
#[derive(Clone, Debug)]
pub(crate) struct Scene {
    pub(crate) name: String,
    pub(crate) cloth: Cloth,
    pub(crate) gravity_m_s2: f64,
}

/// How a run went. All but the time is the same every time.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Run {
    /// Processor time of analysis and response, all frames that were not clean.
    pub(crate) time: Duration,
    /// Frames that were not clean, before it was clean for good.
    pub(crate) tangled_frames: usize,
    /// Those of them for which the host asked.
    pub(crate) answers: usize,
    /// The first frame that was clean and stayed so.
    pub(crate) clean_at: Option<usize>,
    /// Edge-face intersections after [`REMAINING_AFTER`] frames.
    pub(crate) remaining: usize,
    /// How far the worst edge is from its length at rest, as a factor of at least 1, at the end.
    pub(crate) distortion: f64,
    /// Worst sums of forces and torques over those of their lengths.
    pub(crate) residuals: [f64; 2],
}

/// Counts pairs instead of microseconds, so that every run ends its frames at the same place.
#[derive(Debug)]
struct Deadline {
    max_pairs: Option<usize>,
    num_asked: usize,
    corresponds: bool,
}

impl StageObserver for Deadline {
    fn begin(&mut self, stage: Stage) {
        self.corresponds = stage == Stage::Correspond;
    }

    fn end(&mut self) {}

    fn is_spent(&mut self) -> bool {
        self.num_asked += usize::from(self.corresponds);
        self.max_pairs.is_some_and(|most| self.num_asked > most)
    }
}

/// Simulates a scene for at most `limit` frames.
///
/// # Errors
/// A scene that is no cloth.
pub(crate) fn run(scene: &Scene, setup: &Setup, limit: usize) -> Result<Run, Box<dyn Error + Send + Sync>> {
    let mut parameters = Parameters::of_cloth(&scene.cloth, scene.gravity_m_s2);
    parameters.single_precision = setup.wire == Wire::SingleHost;
    let mut solver = Solver::new(scene.cloth.clone(), parameters);
    let mesh = mesh_of(solver.cloth(), solver.masses_kg(), setup.knowledge)?;
    let mut untangler = Untangler::new(Arc::new(mesh), setup.settings.clone())?;
    let mut taken = Taken::default();
    let mut run = Run::default();
    let mut clean_frames = 0;
    for number in 0..=limit {
        let points = solver.cloth().points();
        let num_hits = count_edge_face(&points, &solver.cloth().triangles)?;
        if number <= REMAINING_AFTER {
            run.remaining = num_hits;
        }
        clean_frames = if num_hits == 0 { clean_frames + 1 } else { 0 };
        if clean_frames > HELD {
            run.clean_at = Some(number - HELD);
            break;
        }
        if number == limit {
            break;
        }
        run.tangled_frames += usize::from(num_hits > 0);
        if number % setup.every == 0 {
            let frame = Frame::new(untangler.mesh(), &sent(points, setup.wire))?;
            let mut deadline = Deadline { max_pairs: setup.max_pairs, num_asked: 0, corresponds: false };
            let start = ThreadTime::now();
            let corrections = untangler.process(&frame, &mut deadline).corrections;
            if num_hits > 0 {
                run.time += start.elapsed();
                run.answers += 1;
                let worse = residuals(&frame, corrections, setup.settings.response);
                run.residuals = std::array::from_fn(|which| run.residuals[which].max(worse[which]));
            }
            taken.take_values(corrections, solver.masses_kg(), setup.settings.response);
            taken.take_mask(corrections);
        } else if setup.between != Between::Repeat {
            taken.drop_values();
            if setup.between == Between::Nothing {
                taken.drop_mask();
            }
        }
        solver.step(DT_S, taken.help());
    }
    run.distortion = solver.cloth().worst_edge_ratio().ln().abs().exp();
    Ok(run)
}

/// The positions as they arrive.
pub(crate) fn sent(mut points: Vec<[f64; 3]>, wire: Wire) -> Vec<[f64; 3]> {
    if wire != Wire::Double {
        points.iter_mut().flatten().for_each(|value| *value = f64::from(to_f32(*value)));
    }
    points
}

/// Net momentum and net angular momentum, as parts of the sums of lengths. Forces are looked at before the limit and
/// the pins, as in the correction's header; displacements, of which no such sums are kept, as they are.
fn residuals(frame: &Frame, corrections: &Corrections, response: Response) -> [f64; 2] {
    let centre: Vector3<f64> = frame.positions().iter().map(|position| position.coords).sum();
    #[expect(clippy::cast_precision_loss, reason = "a count of vertices")]
    let centre = Point3::from(centre / frame.positions().len() as f64);
    let arms = || frame.positions().iter().map(|position| position - centre).zip(&corrections.forces);
    let forces: f64 = corrections.forces.iter().map(Vector3::norm).sum();
    let torques: f64 = arms().map(|(arm, force)| arm.norm() * force.norm()).sum();
    let (net_force, net_torque) = match response {
        Response::Displacement | Response::Coupled => {
            (corrections.forces.iter().sum(), arms().map(|(arm, force)| arm.cross(force)).sum())
        }
        Response::Rbf | Response::Contour | Response::Mask => (corrections.net_force, corrections.net_torque),
    };
    let part = |sum: Vector3<f64>, lengths: f64| if lengths > 0.0 { sum.norm() / lengths } else { 0.0 };
    [part(net_force, forces), part(net_torque, torques)]
}
