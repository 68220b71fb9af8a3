//! One repair: relax, round as the host will, check; and once more where rounding brought intersections back.

use std::ops::ControlFlow;

use untangle::{
    frame::Frame,
    intersect::{Intersections, Intersector, SearchEnd, SearchLimits},
    mesh::Mesh,
    paths::{IntersectionPaths, PathFinder},
    relax::{RelaxSettings, Relaxation, relax_until},
    sides::Layers,
    stage::{Stage, StageObserver},
};
use untangled_proto::{
    Precision, RepairHeader, Status,
    correction::NO_FAULT,
    repair::{CERTIFIED, TRUNCATED},
};

use super::{
    displacement, distortion,
    judge::{Verdict, judge},
};

/// Most rounds, each of which relaxes the state that the host would have after the last one.
const MOST_ROUNDS: usize = 8;

/// What is to be repaired.
#[derive(Clone, Copy, Debug)]
pub(super) struct Task<'a> {
    pub(super) mesh: &'a Mesh,
    /// The host's positions, bit for bit.
    pub(super) positions: &'a [[f64; 3]],
    pub(super) precision: Precision,
    /// How much may intersect.
    pub(super) limits: SearchLimits,
}

/// Caller's function that says whether the work is to end.
type ShouldStop<'s> = &'s (dyn Fn() -> bool + Sync);

/// A state that the host can reach.
#[derive(Debug)]
struct Reached {
    displacements: Vec<[f64; 3]>,
    positions: Vec<[f64; 3]>,
    frame: Frame,
    found: Intersections,
    verdict: Verdict,
}

impl Reached {
    /// What is wrong: what intersects or is on the wrong side of a body or a layer, and what the judge alone finds.
    fn rank(&self) -> (usize, usize) {
        (self.found.edge_face.len().saturating_add(self.verdict.num_wrong()), self.verdict.num_crossings)
    }

    fn is_certified(&self) -> bool {
        self.rank() == (0, 0)
    }
}

/// Ends a search that is to stop.
struct StopObserver<'s>(ShouldStop<'s>);

impl StageObserver for StopObserver<'_> {
    fn begin(&mut self, _: Stage) {}
    fn end(&mut self) {}
    fn is_spent(&mut self) -> bool {
        (self.0)()
    }
}

/// Repairs, until `should_stop` at most. The header has the result without frame and times; the displacements are
/// `num_vertices x 3` in metres, of values that the host's precision holds.
pub(super) fn solve(task: &Task<'_>, should_stop: ShouldStop<'_>) -> (RepairHeader, Vec<[f64; 3]>) {
    let Task { mesh, positions, limits, .. } = *task;
    let nothing = || vec![[0.0; 3]; positions.len()];
    let Ok(frame) = Frame::new(mesh, positions) else {
        // The frame was checked when it came.
        return (refused(Status::Internal, 0.0), nothing());
    };
    let mut found = Intersections::default();
    let mut observer = StopObserver(should_stop);
    match Intersector::default().intersect_within(mesh, &frame, limits, &mut observer, &mut found) {
        SearchEnd::Complete => {}
        #[expect(clippy::cast_precision_loss, reason = "only for messages")]
        SearchEnd::TooManyPairs => {
            return (refused(Status::TooManyIntersections, limits.max_found as f64), nothing());
        }
        SearchEnd::OutOfTime => return (refused(Status::OutOfTime, 0.0), nothing()),
    }
    let decided = decide_layers(mesh, &frame);
    let task = &Task { mesh: decided.as_ref().unwrap_or(mesh), ..*task };
    let verdict = judge(task.mesh, positions);
    let (displacements, positions) = (nothing(), positions.to_vec());
    let mut best = Reached { displacements, positions, frame, found, verdict };
    let (num_iterations, truncated) = match best.rank().0 == 0 {
        true => (0, false),
        false => run_rounds(task, &mut best, should_stop),
    };
    let header = describe(task, &best, num_iterations, truncated);
    (header, best.displacements)
}

/// The mesh with what is outwards of its layers decided by a frame, if rest positions have not: no round must turn
/// round what the frame says.
fn decide_layers(mesh: &Mesh, frame: &Frame) -> Option<Mesh> {
    let is_open = mesh.layers().is_some() && mesh.outwards().is_none();
    is_open.then(|| Layers::decide(mesh.clone(), frame))
}

/// Relaxes until a state is certified, or nothing helps. Gives back the number of iterations, and whether it was
/// stopped.
fn run_rounds(task: &Task<'_>, best: &mut Reached, should_stop: ShouldStop<'_>) -> (usize, bool) {
    let Task { mesh, precision, .. } = *task;
    let mut num_iterations = 0;
    let mut start = task.positions.to_vec();
    for _ in 0..MOST_ROUNDS {
        let default = RelaxSettings::default();
        let settings = RelaxSettings {
            max_iterations: default.max_iterations - num_iterations,
            single_precision: precision == Precision::F32,
            // A host waits.
            other_attempts: false,
            ..default
        };
        let mut progress = |_: &_| if should_stop() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
        let Ok(relaxation) = relax_until(mesh, &start, &settings, &mut progress, should_stop) else { break };
        let Relaxation { positions, history, blocked, interrupted } = relaxation;
        num_iterations += history.len().min(settings.max_iterations);
        let Some(reached) = reach(task, &positions) else { break };
        let lost_clean = blocked.is_empty() && !reached.is_certified();
        let next = lost_clean.then(|| reached.positions.clone());
        if reached.rank() < best.rank() {
            *best = reached;
        }
        if interrupted {
            return (num_iterations, true);
        }
        let Some(next) = next.filter(|_| num_iterations < default.max_iterations) else { break };
        // Rounding brought intersections back.
        start = next;
    }
    (num_iterations, false)
}

/// The state that the host has after adding the displacements to `goal`; nothing where its precision can't hold it.
fn reach(task: &Task<'_>, goal: &[[f64; 3]]) -> Option<Reached> {
    let Task { mesh, positions: from, precision, .. } = *task;
    let mut displacements = vec![[0.0; 3]; from.len()];
    let mut positions = from.to_vec();
    for ((slot, position), goal) in displacements.iter_mut().zip(&mut positions).zip(goal) {
        for axis in 0..3 {
            (slot[axis], position[axis]) = displacement::step(precision, position[axis], goal[axis]);
        }
    }
    if !displacements.as_flattened().iter().all(|value| value.is_finite()) {
        return None;
    }
    let frame = Frame::new(mesh, &positions).ok()?;
    let mut found = Intersections::default();
    Intersector::default().intersect(mesh, &frame, &mut found);
    let verdict = judge(mesh, &positions);
    Some(Reached { displacements, positions, frame, found, verdict })
}

fn refused(status: Status, fault_value: f64) -> RepairHeader {
    let flags = if status == Status::Internal { 0 } else { TRUNCATED };
    RepairHeader { status: status.code(), flags, fault_index: NO_FAULT, fault_value, ..RepairHeader::default() }
}

fn describe(task: &Task<'_>, best: &Reached, num_iterations: usize, truncated: bool) -> RepairHeader {
    let mut paths = IntersectionPaths::default();
    PathFinder::default().find(task.mesh, &best.frame, &best.found, &mut paths);
    let certified = if best.is_certified() { CERTIFIED } else { 0 };
    let mut header = RepairHeader {
        status: Status::Ok.code(),
        flags: certified | if truncated { TRUNCATED } else { 0 },
        fault_index: NO_FAULT,
        num_edge_face_intersections: best.found.edge_face.len() as u64,
        num_crossings: best.verdict.num_crossings as u64,
        num_inside_body: best.verdict.num_inside as u64,
        num_behind: best.verdict.num_behind as u64,
        num_pairs: paths.pairs.len() as u64,
        // The sum of no lengths is a negative zero.
        contour_length_m: paths.pairs.iter().map(|pair| pair.length_m).sum::<f64>() + 0.0,
        num_iterations: num_iterations as u64,
        ..RepairHeader::default()
    };
    distortion::measure(&mut header, task.mesh, task.positions, &best.positions);
    header
}
