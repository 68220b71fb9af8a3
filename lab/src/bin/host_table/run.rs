//! One input in the example host, with corrections, until it stays clean.

use std::{
    collections::VecDeque,
    error::Error,
    sync::Arc,
    time::{Duration, Instant},
};

use nalgebra::{Point3, Vector3};
use untangle::{
    frame::Frame,
    respond::Corrections,
    settings::{Response, Settings},
    untangler::Untangler,
};
use untangled_checker::{CheckError, count_edge_face};
use untangled_client::CorrectionKind;
use untangled_lab::host::{DT_S, Taken, mesh_of};
use untangled_publisher::{
    host::{Host, HostOptions, Use},
    repairs::RepairPolicy,
    solver::{Parameters, Solver},
};
use untangled_testkit::generate::mirrored::Knowledge;

use crate::inputs::Input;

/// A state is held when it stays clean for so many steps.
const HELD: usize = 5;
/// Longest time for a frame and for a repair, as long as nothing hangs.
const PATIENCE: Duration = Duration::from_secs(600);

/// How a run ended.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Run {
    /// Edge-face intersections at the start, at the end, and the most in between.
    pub(crate) before: usize,
    pub(crate) after: usize,
    pub(crate) most: usize,
    /// Steps to the first clean state that was held.
    pub(crate) steps: Option<usize>,
    /// The ratio of an edge to its length at rest that is farthest from 1, as a factor of at least 1, at the end.
    pub(crate) distortion: f64,
    /// The most that was left of momentum and of angular momentum, as parts of the sums of lengths; zeros where the
    /// host does not see it.
    pub(crate) left: [f64; 2],
    /// Time of analysis and response, or of the exchange with the daemon, and of how many tangled steps.
    pub(crate) time: Duration,
    pub(crate) busy_steps: u32,
}

/// How an input is simulated.
#[derive(Clone, Copy, Debug)]
pub(crate) struct How {
    pub(crate) most_steps: usize,
    /// Whether the host leaves out single contacts by labels, instead of masking vertices.
    pub(crate) labels: bool,
    /// Steps by which corrections are late, as in a host that does not wait for them.
    pub(crate) steps_behind: usize,
    pub(crate) verbose: bool,
}

impl Run {
    /// Takes note of a state; whether the run ends with it.
    fn look(
        &mut self,
        step: usize,
        solver: &Solver,
        clean_steps: &mut usize,
        most_steps: usize,
    ) -> Result<bool, CheckError> {
        let cloth = solver.cloth();
        self.after = count_edge_face(&cloth.points(), &cloth.triangles)?;
        self.most = self.most.max(self.after);
        if step == 0 {
            self.before = self.after;
        }
        *clean_steps = if self.after == 0 { *clean_steps + 1 } else { 0 };
        if *clean_steps > HELD {
            self.steps = Some(step - HELD);
        }
        let is_last = self.steps.is_some() || step == most_steps;
        if is_last {
            self.distortion = cloth.worst_edge_ratio().ln().abs().exp();
        }
        Ok(is_last)
    }

    fn add_time(&mut self, time: Duration) {
        if self.after > 0 {
            self.time += time;
            self.busy_steps += 1;
        }
    }
}

/// Simulates an input until it stays clean, with the library in this process.
///
/// # Errors
/// An input that is no cloth.
pub(crate) fn run(input: &Input, settings: &Settings, how: &How) -> Result<Run, Box<dyn Error>> {
    let How { most_steps, labels, steps_behind, verbose } = *how;
    let mut solver = solver(input);
    let mesh = Arc::new(mesh_of(solver.cloth(), solver.masses_kg(), Knowledge::Uvs)?);
    let mut untangler = Untangler::new(mesh, settings.clone())?;
    untangler.set_labelled(labels);
    let mut under_way = VecDeque::from(vec![Taken::default(); steps_behind]);
    let (mut run, mut clean_steps) = (Run::default(), 0);
    for step in 0.. {
        if run.look(step, &solver, &mut clean_steps, most_steps)? {
            break;
        }
        let frame = Frame::new(untangler.mesh(), &solver.cloth().points())?;
        let begin = Instant::now();
        let outcome = untangler.process(&frame, &mut ());
        run.add_time(begin.elapsed());
        let corrections = outcome.corrections;
        if run.after > 0 {
            let left = left_over(&frame, corrections, settings.response);
            run.left = std::array::from_fn(|which| run.left[which].max(left[which]));
        }
        if verbose {
            let pairs = outcome.analysis.paths.pairs.iter().map(|pair| (pair.pair_type, pair.num_segments));
            let moved = corrections.max_displacement_m;
            println!("  {step:>4} {:>5} {moved:.5} {:?}", run.after, pairs.collect::<Vec<_>>());
        }
        let mut taken = Taken::default();
        taken.take_values(corrections, solver.masses_kg(), settings.response);
        if labels {
            taken.take_labels(corrections);
        } else {
            taken.take_mask(corrections);
        }
        under_way.push_back(taken);
        let arrived = under_way.pop_front().unwrap_or_default();
        solver.step(DT_S, arrived.help());
    }
    Ok(run)
}

/// Simulates an input until it stays clean, as the example host does with a daemon that repairs.
///
/// # Errors
/// An input that is no cloth, or no daemon.
pub(crate) fn run_repaired(
    input: &Input,
    repair: RepairPolicy,
    how: &How,
    domain: &str,
) -> Result<Run, Box<dyn Error>> {
    let options = HostOptions {
        domain: Some(domain.to_owned()),
        connect_timeout: PATIENCE,
        deadline: PATIENCE,
        dt_s: DT_S,
        correction: CorrectionKind::VelocityChange,
        use_of_corrections: Use::Everything,
        repair,
        repair_deadline: PATIENCE,
        settings: serde_json::Value::Null,
    };
    let mut host = Host::new(solver(input), options)?;
    let (mut run, mut clean_steps) = (Run::default(), 0);
    for step in 0.. {
        if run.look(step, host.solver(), &mut clean_steps, how.most_steps)? {
            break;
        }
        let begin = Instant::now();
        let report = host.exchange()?;
        run.add_time(begin.elapsed());
        if how.verbose {
            println!("  {step:>4} {:>5} repaired: {:?}", run.after, report.repaired);
        }
        host.advance();
    }
    Ok(run)
}

fn solver(input: &Input) -> Solver {
    Solver::new(input.cloth.clone(), Parameters::of_cloth(&input.cloth, input.gravity_m_s2))
}

/// Net momentum and net angular momentum as parts of the sums of lengths: of forces before the limit and the pins, as
/// in the correction's header, of displacements as they are.
fn left_over(frame: &Frame, corrections: &Corrections, response: Response) -> [f64; 2] {
    let sum: Vector3<f64> = frame.positions().iter().map(|position| position.coords).sum();
    #[expect(clippy::cast_precision_loss, reason = "a count of vertices")]
    let centre = Point3::from(sum / frame.positions().len() as f64);
    let arms = || frame.positions().iter().map(|position| position - centre).zip(&corrections.forces);
    let (net_force, net_torque) = match response {
        Response::Displacement | Response::Coupled => {
            (corrections.forces.iter().sum(), arms().map(|(arm, force)| arm.cross(force)).sum())
        }
        Response::Rbf | Response::Contour | Response::Mask => (corrections.net_force, corrections.net_torque),
    };
    let part = |sum: Vector3<f64>, lengths: f64| if lengths > 0.0 { sum.norm() / lengths } else { 0.0 };
    [
        part(net_force, corrections.forces.iter().map(Vector3::norm).sum()),
        part(net_torque, arms().map(|(arm, force)| arm.norm() * force.norm()).sum()),
    ]
}
