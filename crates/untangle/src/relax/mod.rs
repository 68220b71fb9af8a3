//! The quasi-static solver behind `untangled fix`: from a tangled state to one without intersections, near to it.

mod approach;
mod blocked;
mod candidate;
mod clusters;
mod coupled;
mod damping;
mod domain;
mod goals;
mod guard;
mod local;
mod membrane;
mod motion;
mod orient;
mod plan;
mod settle;
mod shape;
mod solver;
mod straighten;

use std::ops::ControlFlow;

pub use coupled::CoupledStep;

pub use crate::settings::Quality;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::{frame::FrameError, mesh::Mesh, paths::PairType};

/// What a caller chooses.
#[derive(Clone, Debug, PartialEq)]
pub struct RelaxSettings {
    /// Time against result.
    pub quality: Quality,
    /// Gives up after this many iterations.
    pub max_iterations: usize,
    /// Whether positions are rounded to single precision in each state, for files that hold no more.
    pub single_precision: bool,
}

impl Default for RelaxSettings {
    fn default() -> Self {
        Self { quality: Quality::default(), max_iterations: 100, single_precision: false }
    }
}

/// What moved the cloth in an iteration.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Method {
    /// Targets by radial basis functions.
    Rbf,
    /// Back to the path along one direction for each path.
    Push,
    /// Down the gradient of the path length.
    Contour,
    /// All of a piece drawn flat, where nothing else helped, and back from there.
    Straighten,
    /// Back towards the shape of the input, with nothing left to resolve.
    Settle,
}

/// The state after an iteration.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Iteration {
    /// Edge-face intersections that are left.
    pub num_edge_face_intersections: usize,
    /// World length of all paths, in metres.
    pub path_length_m: f64,
    /// What led here.
    pub method: Method,
}

/// A path that could not be resolved.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockedPath {
    /// Its type.
    pub pair_type: PairType,
    /// A vertex beside it, to find it by.
    pub vertex: u32,
    /// World length in metres.
    pub length_m: f64,
    /// Why, in words.
    pub reason: String,
}

/// The best state found, and how it came about.
#[derive(Clone, Debug, PartialEq)]
pub struct Relaxation {
    /// Positions in metres, `num_vertices x 3`. Those of the input, bit for bit, if that was clean.
    pub positions: Vec<[f64; 3]>,
    /// One entry for each iteration.
    pub history: Vec<Iteration>,
    /// Paths left in `positions`; empty if none are.
    pub blocked: Vec<BlockedPath>,
    /// Whether `progress` ended it.
    pub interrupted: bool,
}

/// Why positions can't be relaxed.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum RelaxError {
    /// Positions were refused.
    #[error(transparent)]
    Frame(#[from] FrameError),
}

/// Brings the cloth apart. `progress` hears of each iteration and may end the work; the best state so far is returned then.
///
/// # Errors
/// [`RelaxError`] for positions that no frame accepts.
pub fn relax(
    mesh: &Mesh,
    positions: &[[f64; 3]],
    settings: &RelaxSettings,
    progress: &mut dyn FnMut(&Iteration) -> ControlFlow<()>,
) -> Result<Relaxation, RelaxError> {
    solver::Relaxer::new(mesh, positions, settings)?.run(progress)
}
