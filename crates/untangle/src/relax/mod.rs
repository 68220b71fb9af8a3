//! The quasi-static solver behind `untangled fix`: from a tangled state to one without intersections, near to it.
//!
//! | file or folder | purpose |
//! |---|---|
//! | [`settings`](RelaxSettings), [`outcome`](Relaxation) | what a caller chooses, and gets |
//! | `energy` | what a displacement costs: as rigid as possible, bending |
//! | `constraints` | what it has to satisfy: separation constraints from the paths, strain limits |
//! | `sides` | what is inside of bodies, and the constraints that bring it out |
//! | `step` | one step: the displacement, contacts, line search, islands of coupled contours |
//! | `plan` | which displacements are tried, and in which order of plans |
//! | `relaxer` | the state of a relaxation under way |
//! | `escape` | the nearest plan: sheets leave each other by the shortest motions |
//! | `resolve` | iterations of trial displacements |
//! | `nudge` | single vertices, for the little that is left |
//! | `multilevel` | coarser meshes, and their states carried over to the finer one |
//! | `attempt` | these three from the input, one where the other ends stuck |
//! | `flattening` | the last resort: pieces are flattened, and recover from there |
//! | `settle` | shape recovery once nothing intersects |
//! | `alternatives` | an attempt in the order in which pieces lie, and others where an end is far from the input |
//! | `input` | what is known of the input before anything moves |
//! | `solver` | all plans, one after the other |
//! | `canonical` | the solver on a form of the input that hangs on its shape alone |
//! | `clearance` | primitives that are nearer than a gap are set apart |
//! | `proposal` | what one frame proposes as a displacement, judged before it goes out |
//!
//! A row uses those above it only.

mod alternatives;
mod attempt;
mod canonical;
mod clearance;
mod constraints;
mod energy;
mod escape;
mod flattening;
mod input;
mod multilevel;
mod nudge;
mod outcome;
mod plan;
mod proposal;
mod relaxer;
mod resolve;
mod settings;
mod settle;
mod sides;
mod solver;
mod step;

use std::ops::ControlFlow;

use crate::mesh::Mesh;

pub use clearance::{Clearance, ClearanceObstacle, InfeasiblePlace, open_gap};
pub use constraints::STRETCH_LIMIT;
pub(crate) use energy::nearest_rotation;
pub use outcome::{BlockedPath, Iteration, Method, RelaxError, Relaxation};
pub(crate) use proposal::{AnalysedFrame, Proposer};
pub use settings::{Effort, RelaxSettings};

/// Moves vertices until nothing intersects, or nothing helps any more. `positions` are in metres, `num_vertices x 3`.
/// `progress` is called after each iteration and may end the work; the best state so far is returned then. See
/// [`relax_until`] for an end within an iteration.
///
/// Where pieces that intersect lie over each other, the first attempt takes each to belong where most of it is.
/// Where the first attempt took a long way, and ended far from the input, others are made from the input, side by side,
/// and the end that costs least is kept, with its history. Where only straightening would help, coarser meshes come
/// first. These tell `progress` nothing.
///
/// Cost: an iteration takes up to 18 trial displacements, in parallel; each has some factorisations of a sparse system
/// over the vertices near the intersections. There are up to 13 other attempts, and those on
/// coarser meshes.
///
/// # Errors
/// [`RelaxError`] for positions that no frame accepts.
pub fn relax(
    mesh: &Mesh,
    positions: &[[f64; 3]],
    settings: &RelaxSettings,
    progress: &mut dyn FnMut(&Iteration) -> ControlFlow<()>,
) -> Result<Relaxation, RelaxError> {
    relax_until(mesh, positions, settings, progress, &|| false)
}

/// As [`relax`], and also ends when `should_stop` says so, which must go on saying so from then on. It is asked from
/// several threads at once, before each search for intersections and in each step of a solution; one search, one
/// factorisation and the analysis of one path are not interrupted. The best state so far is returned then.
///
/// # Errors
/// [`RelaxError`] for positions that no frame accepts.
pub fn relax_until(
    mesh: &Mesh,
    positions: &[[f64; 3]],
    settings: &RelaxSettings,
    progress: &mut dyn FnMut(&Iteration) -> ControlFlow<()>,
    should_stop: &(dyn Fn() -> bool + Sync),
) -> Result<Relaxation, RelaxError> {
    canonical::run(mesh, positions, settings, progress, should_stop)
}
