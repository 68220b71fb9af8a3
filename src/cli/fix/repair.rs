//! The repair: relax, write, read back, check; and once more where rounding in the file brought intersections back, or
//! where another reader of the file finds some.

use std::{ops::ControlFlow, path::PathBuf, sync::atomic::Ordering, time::Instant};

use untangle::{
    analysis::{Analysis, analyse},
    frame::Frame,
    intersect::{Intersections, Intersector},
    mesh::{Mesh, VertexId},
    relax::{BlockedPath, Iteration, RelaxError, RelaxSettings, Relaxation},
    sides::{Layers, Sides},
};
use untangled_mesh_io::{MeshFile, read_mesh};

use crate::cli::{certificate::Certificate, input::Input, roles::Roles};

use super::{
    error::FixError,
    plan::Job,
    report::{Blocked, Counts},
    target::Staged,
    terminal::{Interrupt, Progress},
    view::View,
};

/// The untangling: [`relax_until`](untangle::relax::relax_until), or a substitute in tests.
pub(super) type Solver<'a> = &'a mut dyn FnMut(
    &Mesh,
    &[[f64; 3]],
    &RelaxSettings,
    &mut dyn FnMut(&Iteration) -> ControlFlow<()>,
    &(dyn Fn() -> bool + Sync),
) -> Result<Relaxation, RelaxError>;

/// Most rounds, each of which relaxes the state that was read back from the files of the last one.
const MOST_ROUNDS: usize = 8;

/// Temporary files beside their places, and their contents.
#[derive(Debug)]
pub(super) struct Written {
    pub(super) staged: Vec<Staged>,
    /// The files read back, as one world.
    pub(super) input: Input,
    pub(super) counts: Counts,
    analysis: Analysis,
}

/// The result of a repair.
#[derive(Debug)]
pub(super) struct Repaired {
    pub(super) written: Written,
    pub(super) history: Vec<Iteration>,
    pub(super) blocked: Vec<Blocked>,
    /// Whether the untangling was ended by the time limit.
    pub(super) time_limit_reached: bool,
}

impl Repaired {
    /// Of an input that needs no repair.
    pub(super) fn unchanged(written: Written) -> Self {
        Self { written, history: Vec::new(), blocked: Vec::new(), time_limit_reached: false }
    }
}

/// The parts of a repair that do not change between rounds.
#[derive(Debug)]
pub(super) struct Repair<'a> {
    pub(super) files: &'a [MeshFile],
    pub(super) roles: &'a Roles,
    pub(super) jobs: &'a [Job<'a>],
    pub(super) pins: &'a [u32],
    pub(super) settings: RelaxSettings,
    /// When the untangling is to end.
    pub(super) deadline: Option<Instant>,
}

/// The result of one round.
#[derive(Debug)]
struct Round {
    written: Written,
    blocked: Vec<BlockedPath>,
    /// Whether the relaxation left nothing, but a reader of what was written finds something.
    lost_clean: bool,
    interrupted: bool,
}

impl Repair<'_> {
    /// Writes positions of the world to temporary files, reads these back and analyses them.
    pub(super) fn write(
        &self,
        start: &Input,
        positions: &[[f64; 3]],
        interrupt: &Interrupt,
    ) -> Result<Written, FixError> {
        let (mut staged, mut meshes, mut names): (Vec<Staged>, Vec<MeshFile>, Vec<PathBuf>) = Default::default();
        for Job { output, target, vertices } in self.jobs {
            let file = target.stage(interrupt, |out| {
                output.write(&positions[vertices.clone()], out).map_err(|source| target.failed(&source))
            })?;
            let mesh = read_mesh(file.path()).map_err(|mut error| {
                error.path.clone_from(&target.path);
                FixError::ReadBack(error.into())
            })?;
            output.check_read_back(&positions[vertices.clone()], &mesh).map_err(|source| target.failed(&source))?;
            names.push(target.path.clone());
            meshes.push(mesh);
            staged.push(file);
        }
        let mut world = self.roles.join(&names, &meshes).map_err(FixError::ReadBack)?;
        world.description.pins = self.pins.to_vec();
        // What was one place is one place: the weld of the input is that of the output.
        let input = Input::with_weld(&meshes, world, start.weld.clone()).map_err(FixError::ReadBack)?;
        let analysis = analyse(&input.mesh, &input.frame);
        let counts = Counts::new(&analysis, self.roles, &input, Certificate::of(&meshes, self.roles, &input));
        Ok(Written { staged, counts, analysis, input })
    }

    /// Relaxes a state that is not clean and writes the best result. Another round follows where a state was clean
    /// before its files rounded it, as long as iterations are left.
    pub(super) fn run(
        &self,
        input: &Input,
        before: &Counts,
        solver: Solver<'_>,
        interrupt: &Interrupt,
        progress: &mut Progress,
    ) -> Result<Repaired, FixError> {
        let mut history: Vec<Iteration> = Vec::new();
        let mut best: Option<Round> = None;
        let mut next: Option<Input> = None;
        let mut time_limit_reached = false;
        let mut counts = before.clone();
        for _ in 0..MOST_ROUNDS {
            let start = next.as_ref().unwrap_or(input);
            let Some(view) = View::of(self.files, self.roles, self.pins, start, &counts) else { break };
            let round = self.round(start, &view, &mut history, &mut *solver, interrupt, progress)?;
            // Rounding or another diagonal brought intersections back: the next round starts from what was read back.
            time_limit_reached |= round.interrupted;
            let go_on = round.lost_clean && !self.is_late() && history.len() < self.settings.max_iterations;
            next = go_on.then(|| round.written.input.clone());
            counts = round.written.counts.clone();
            if best.as_ref().is_none_or(|best| rank(&round.written.counts) < rank(&best.written.counts)) {
                best = Some(round);
            }
            if !go_on {
                break;
            }
        }
        let Some(Round { mut written, blocked, .. }) = best else {
            return Ok(Repaired::unchanged(self.write(input, &input.positions, interrupt)?));
        };
        let mut blocked: Vec<Blocked> = blocked.into_iter().map(Blocked::from).collect();
        let is_worse = rank(&written.counts).0 > rank(before).0;
        let is_vain = before.is_clean() && rank(&written.counts) >= rank(before);
        if is_worse || is_vain {
            // Rounding made the state worse than the input, or nothing helped another reader.
            written = self.write(input, &input.positions, interrupt)?;
            blocked.clear();
        }
        if written.counts.is_clean() {
            blocked.clear();
        } else if blocked.is_empty() {
            blocked = self.unresolved(&written, history.len());
        }
        blocked.extend(Blocked::inside_bodies(&written.input));
        Ok(Repaired { written, history, blocked, time_limit_reached })
    }

    /// Relaxes a state once and writes it; appends its iterations to `history`.
    fn round(
        &self,
        start: &Input,
        view: &View,
        history: &mut Vec<Iteration>,
        solver: Solver<'_>,
        interrupt: &Interrupt,
        progress: &mut Progress,
    ) -> Result<Round, FixError> {
        let max_iterations = self.settings.max_iterations - history.len();
        let single_precision = self.settings.single_precision || view.single_precision;
        let settings = RelaxSettings { max_iterations, single_precision, ..self.settings.clone() };
        let welded = start.weld.gather(&start.positions);
        let asked = interrupt.flag();
        let should_stop = || asked.load(Ordering::Relaxed) || self.is_late();
        let mut after_iteration = |iteration: &Iteration| {
            progress.iteration(iteration);
            if should_stop() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let seen: Vec<[f64; 3]> = view.frame.positions().iter().map(|point| (*point).into()).collect();
        let mut relaxation =
            solver(&view.mesh, &seen, &settings, &mut after_iteration, &should_stop).map_err(FixError::Relax)?;
        interrupt.check()?;
        progress.say("checking what is written");
        // A solver that counts an iteration too many must not make the subtraction above overflow.
        let own = relaxation.history.iter().take(max_iterations);
        // The sum of no lengths is a negative zero.
        history.extend(own.map(|step| Iteration { path_length_m: step.path_length_m + 0.0, ..*step }));
        let was_clean = is_clean(&view.mesh, &relaxation.positions)?;
        for ((position, start), seen) in relaxation.positions.iter_mut().zip(&welded).zip(&seen) {
            // A reader may see rounded positions, or tiny ones as zero. What did not move keeps its bits.
            if position.map(f64::to_bits) == seen.map(f64::to_bits) {
                *position = *start;
            }
        }
        for path in &mut relaxation.blocked {
            path.vertex = start.weld.first(VertexId(path.vertex));
        }
        let positions = start.weld.scatter(&start.positions, &relaxation.positions);
        let written = self.write(start, &positions, interrupt)?;
        interrupt.check()?;
        let lost_clean = was_clean && !written.counts.is_certified();
        Ok(Round { written, blocked: relaxation.blocked, lost_clean, interrupted: relaxation.interrupted })
    }

    /// Whether the time limit has passed.
    pub(super) fn is_late(&self) -> bool {
        self.deadline.is_some_and(|deadline| Instant::now() >= deadline)
    }

    /// All paths of a state for which the solver gave no reason.
    fn unresolved(&self, written: &Written, num_iterations: usize) -> Vec<Blocked> {
        let reason = if num_iterations >= self.settings.max_iterations {
            format!("not resolved within {num_iterations} iterations")
        } else {
            "not resolved".to_owned()
        };
        let paths = &written.analysis.paths;
        let blocked = paths.pairs.iter().filter_map(|pair| {
            let copy = paths.copies[pair.copies.clone()].first()?;
            let face = paths.segments[copy.segments.clone()].first()?.own;
            let vertex = pair.loop_vertices.first().copied().unwrap_or(written.input.mesh.face(face)[0]);
            Some(Blocked::from(BlockedPath {
                pair_type: pair.pair_type,
                vertex: written.input.weld.first(vertex),
                length_m: pair.length_m,
                reason: reason.clone(),
            }))
        });
        blocked.collect()
    }
}

/// How far a state is from clean: what intersects in it or is on the wrong side first, then what readers find.
pub(super) fn rank(counts: &Counts) -> (usize, usize) {
    (counts.num_edge_face_intersections + counts.num_wrong(), counts.certificate.total())
}

/// Whether positions in memory have no intersection, and no vertex on the wrong side.
fn is_clean(mesh: &Mesh, positions: &[[f64; 3]]) -> Result<bool, FixError> {
    let frame = Frame::new(mesh, positions).map_err(|source| FixError::Relax(source.into()))?;
    let mut intersections = Intersections::default();
    Intersector::default().intersect(mesh, &frame, &mut intersections);
    let sides = Sides::of(mesh, &frame);
    let is_outside = sides.as_ref().is_none_or(|sides| sides.wrong_vertices(mesh, &frame).is_empty());
    let layers = Layers::of(mesh, &frame, sides.as_ref());
    let is_in_order = layers.is_none_or(|layers| layers.behind(mesh, frame.positions()).is_empty());
    Ok(intersections.edge_face.is_empty() && is_outside && is_in_order)
}
