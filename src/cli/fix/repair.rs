//! The repair itself: relax, write, read back, check; and again, if the file could not hold what was found.

use std::{
    ops::{ControlFlow, Range},
    path::PathBuf,
};

use super::{
    FixError,
    interrupt::Interrupt,
    progress::Progress,
    report::{Blocked, Counts},
    target::{Staged, Target},
};
use untangle::{analysis::{Analysis, analyse}, frame::Frame, intersect::{Intersections, Intersector}, mesh::Mesh, relax::{BlockedPath, Iteration, RelaxError, RelaxSettings, Relaxation}};
use crate::cli::input::{self, Input};
use untangled_mesh_io::{MeshFile, Output, read_mesh};

/// What brings a state apart: [`relax`](untangle::relax::relax), or what a test puts in its place.
pub(super) type Solver<'a> = &'a mut dyn FnMut(
    &Mesh,
    &[[f64; 3]],
    &RelaxSettings,
    &mut dyn FnMut(&Iteration) -> ControlFlow<()>,
) -> Result<Relaxation, RelaxError>;

/// How often a state is relaxed that the file could not hold.
const MOST_ROUNDS: usize = 6;

/// One output file.
#[derive(Debug)]
pub(super) struct Job<'a> {
    pub(super) output: Output<'a>,
    pub(super) target: Target,
    /// The vertices of the world that it holds.
    pub(super) vertices: Range<usize>,
}

/// Files beside their places, and what they hold.
#[derive(Debug)]
pub(super) struct Written {
    pub(super) staged: Vec<Staged>,
    /// The files read back, as one world.
    pub(super) input: Input,
    pub(super) counts: Counts,
    analysis: Analysis,
}

/// A repair that came to its end.
#[derive(Debug)]
pub(super) struct Repaired {
    pub(super) written: Written,
    pub(super) history: Vec<Iteration>,
    pub(super) blocked: Vec<Blocked>,
}

/// Everything that stays the same during a repair.
#[derive(Debug)]
pub(super) struct Repair<'a> {
    pub(super) jobs: &'a [Job<'a>],
    pub(super) pins: &'a [u32],
    pub(super) settings: RelaxSettings,
}

impl Repair<'_> {
    /// Writes positions of the world to temporary files, reads these back and analyses them.
    pub(super) fn write(&self, positions: &[[f64; 3]]) -> Result<Written, FixError> {
        let (mut staged, mut meshes, mut names): (Vec<Staged>, Vec<MeshFile>, Vec<PathBuf>) = Default::default();
        for Job { output, target, vertices } in self.jobs {
            let file = target.stage(|out| {
                output.write(&positions[vertices.clone()], out).map_err(|source| target.failed(&source))
            })?;
            let mesh = read_mesh(file.path()).map_err(|mut error| {
                error.path.clone_from(&target.path);
                FixError::ReadBack(error.into())
            })?;
            names.push(target.path.clone());
            meshes.push(mesh);
            staged.push(file);
        }
        let mut world = input::join(&names, &meshes).map_err(FixError::ReadBack)?;
        world.description.pins = self.pins.to_vec();
        let input = Input::new(&meshes, world).map_err(FixError::ReadBack)?;
        let analysis = analyse(&input.mesh, &input.frame);
        Ok(Written { staged, counts: Counts::new(&analysis), analysis, input })
    }

    /// Relaxes a state that is not clean until what is written is, or there is nothing more to be done.
    pub(super) fn run(
        &self,
        input: &Input,
        before: &Counts,
        solver: Solver<'_>,
        interrupt: &mut Interrupt,
        progress: &mut Progress,
    ) -> Result<Repaired, FixError> {
        let mut history: Vec<Iteration> = Vec::new();
        let mut best: Option<(Written, Vec<BlockedPath>)> = None;
        let mut next: Option<Input> = None;
        for _ in 0..MOST_ROUNDS {
            let Input { mesh, positions, .. } = next.as_ref().unwrap_or(input);
            let settings =
                RelaxSettings { max_iterations: self.settings.max_iterations - history.len(), ..self.settings.clone() };
            let relaxation = solver(mesh, positions, &settings, &mut |iteration| {
                progress.iteration(iteration);
                if interrupt.is_asked() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            })
            .map_err(FixError::Relax)?;
            interrupt.check()?;
            progress.say("checking what is written");
            // A solver that counts one iteration too many costs one, not a panic.
            history.extend(relaxation.history.iter().take(settings.max_iterations));
            let was_clean = is_clean(mesh, &relaxation.positions)?;
            interrupt.wait_for_files();
            let written = self.write(&relaxation.positions)?;
            interrupt.check()?;
            // The file holds other digits, or splits a polygon in another way than before: its own state is where to go on.
            let go_on = was_clean && !written.counts.is_clean() && history.len() < self.settings.max_iterations;
            next = go_on.then(|| written.input.clone());
            let hits = |written: &Written| written.counts.num_edge_face_intersections;
            if best.as_ref().is_none_or(|(best, _)| hits(&written) < hits(best)) {
                best = Some((written, relaxation.blocked));
            }
            if !go_on {
                break;
            }
        }
        let (mut written, blocked) = best.unwrap_or_else(|| unreachable!("there is at least one round"));
        let mut blocked: Vec<Blocked> = blocked.into_iter().map(Blocked::from).collect();
        if written.counts.num_edge_face_intersections > before.num_edge_face_intersections {
            // Rounding made it worse than it was.
            written = self.write(&input.positions)?;
            blocked.clear();
        }
        if written.counts.is_clean() {
            blocked.clear();
        } else if blocked.is_empty() {
            blocked = self.left(&written, history.len());
        }
        Ok(Repaired { written, history, blocked })
    }

    /// All paths of a state that the solver said nothing about.
    fn left(&self, written: &Written, num_iterations: usize) -> Vec<Blocked> {
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
            Some(Blocked {
                pair_type: pair.pair_type,
                vertex: vertex.0,
                length_m: pair.length_m,
                reason: reason.clone(),
            })
        });
        blocked.collect()
    }
}

/// Whether positions in memory have no intersection.
fn is_clean(mesh: &Mesh, positions: &[[f64; 3]]) -> Result<bool, FixError> {
    let frame = Frame::new(mesh, positions).map_err(|source| FixError::Relax(source.into()))?;
    let mut intersections = Intersections::default();
    Intersector::default().intersect(mesh, &frame, &mut intersections);
    Ok(intersections.edge_face.is_empty())
}
