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
use untangled_mesh_io::{CacheFrame, MeshFile, WriteError, read_mesh};

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

/// Where a repair keeps its states.
#[derive(Clone, Copy, Debug)]
pub(in crate::cli) enum Store<'a> {
    /// In temporary files beside their places, which are read back.
    Files(&'a [Job<'a>]),
    /// In memory, as a frame of a cache holds them.
    Frame(&'a CacheFrame),
}

/// Temporary files beside their places, and their contents.
#[derive(Debug)]
pub(in crate::cli) struct Written {
    pub(super) staged: Vec<Staged>,
    /// The files read back, as one world.
    pub(in crate::cli) input: Input,
    pub(in crate::cli) counts: Counts,
    pub(super) analysis: Analysis,
}

/// The result of a repair.
#[derive(Debug)]
pub(in crate::cli) struct Repaired {
    pub(in crate::cli) written: Written,
    pub(in crate::cli) history: Vec<Iteration>,
    pub(in crate::cli) blocked: Vec<Blocked>,
    /// Whether the untangling was ended by the time limit.
    pub(super) time_limit_reached: bool,
}

impl Repaired {
    /// Of an input that needs no repair.
    pub(in crate::cli) fn unchanged(written: Written) -> Self {
        Self { written, history: Vec::new(), blocked: Vec::new(), time_limit_reached: false }
    }
}

/// The parts of a repair that do not change between rounds.
#[derive(Debug)]
pub(in crate::cli) struct Repair<'a> {
    pub(in crate::cli) files: &'a [MeshFile],
    pub(in crate::cli) roles: &'a Roles,
    pub(in crate::cli) store: Store<'a>,
    pub(in crate::cli) pins: &'a [u32],
    pub(in crate::cli) settings: RelaxSettings,
    /// When the untangling is to end.
    pub(in crate::cli) deadline: Option<Instant>,
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
    /// Writes positions of the world to where states are kept, reads them back and analyses them.
    pub(in crate::cli) fn write(
        &self,
        start: &Input,
        positions: &[[f64; 3]],
        interrupt: &Interrupt,
    ) -> Result<Written, FixError> {
        let (staged, meshes, names) = match self.store {
            Store::Files(jobs) => write_files(jobs, positions, interrupt)?,
            Store::Frame(frame) => (Vec::new(), self.in_frame(frame, positions).map_err(FixError::Store)?, Vec::new()),
        };
        let mut world = self.roles.join(&names, &meshes).map_err(FixError::ReadBack)?;
        world.description.pins = self.pins.to_vec();
        // What was one place is one place: the weld of the input is that of the output.
        let input = Input::with_weld(&meshes, world, start.weld.clone()).map_err(FixError::ReadBack)?;
        let input = input.with_outwards(start.mesh.outwards());
        let analysis = analyse(&input.mesh, &input.frame);
        let counts = Counts::new(&analysis, self.roles, &input, Certificate::of(&meshes, self.roles, &input));
        Ok(Written { staged, counts, analysis, input })
    }

    /// Relaxes a state that is not clean and writes the best result. Another round follows where a state was clean
    /// before its files rounded it, as long as iterations are left.
    pub(in crate::cli) fn run(
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

    /// The cloth as a frame holds it.
    fn in_frame(&self, frame: &CacheFrame, positions: &[[f64; 3]]) -> Result<Vec<MeshFile>, WriteError> {
        let cloth = positions.get(..frame.positions().len()).unwrap_or(positions);
        let stored = frame.stored_positions(cloth)?;
        let mut first = 0;
        let at = |file: &MeshFile| {
            let own = first..first + file.positions().len();
            first = own.end;
            file.at_positions(stored.get(own).unwrap_or_default())
        };
        self.files.iter().map(at).collect()
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

/// Temporary files, what is read back from them, and the names of their places.
type WrittenFiles = (Vec<Staged>, Vec<MeshFile>, Vec<PathBuf>);

/// Writes positions of the world to temporary files, and reads these back.
fn write_files(jobs: &[Job<'_>], positions: &[[f64; 3]], interrupt: &Interrupt) -> Result<WrittenFiles, FixError> {
    let (mut staged, mut meshes, mut names) = WrittenFiles::default();
    for Job { output, target, vertices } in jobs {
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
    Ok((staged, meshes, names))
}

/// How far a state is from clean: what intersects in it or is on the wrong side first, then what readers find.
pub(in crate::cli) fn rank(counts: &Counts) -> (usize, usize) {
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
