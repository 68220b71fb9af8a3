//! The coupled response of one frame: one motion that resolves all paths together, without trials and without history.

use nalgebra::Vector3;

use super::{
    domain::Domain,
    goals::{Aim, Goals, Scene},
    motion::MotionSolver,
    orient::Orientation,
    shape::{Body, Shape},
};
use crate::{
    analysis::Analysis,
    correspond::Correspondences,
    frame::Frame,
    geometry::mean_edge_length,
    mesh::{Mesh, VertexId},
};

/// Rings round the goals that may move.
const RINGS: usize = 10;
/// The root of this is the length, in edges, over which a motion dies away.
const STIFFNESS: f64 = 16.0;
/// Edges that change their length by more than this factor are made stiffer.
const TOLERATED: f64 = 1.2;
/// Longest motion of one frame, in mean edge lengths.
const LONGEST: f64 = 6.0;

/// Finds coupled motions, reusing its memory from frame to frame.
#[derive(Debug, Default)]
pub struct CoupledStep {
    orientation: Option<Orientation>,
    domain: Domain,
    goals: Goals,
    solver: MotionSolver,
}

impl CoupledStep {
    /// Finds the motion for one frame of the mesh that this was first used with, and calls `add` with each vertex that moves and its
    /// displacement in metres. Pinned vertices don't move. Nothing where nothing intersects.
    ///
    /// The least change of the present shape, as rigid as possible, that takes every point inside to the other side of the sheet it
    /// penetrated, and the paths without an inside to a shorter length. Paths that time did not suffice for want nothing. Momentum is not
    /// kept. Cost: see `fix`; it allocates, and once begun it is not cut short.
    pub fn step(
        &mut self,
        mesh: &Mesh,
        frame: &Frame,
        analysis: &Analysis,
        found: &Correspondences,
        mut add: impl FnMut(VertexId, Vector3<f64>),
    ) {
        let Some(edge_length_m) =
            mean_edge_length(mesh, frame, analysis.paths.segments.iter().map(|segment| segment.own))
        else {
            return;
        };
        let orientation = &*self.orientation.get_or_insert_with(|| Orientation::of(mesh));
        self.goals.collect(&Scene { mesh, frame, analysis, found, orientation }, Aim::Normal);
        if self.goals.len() == 0 {
            return;
        }
        self.domain.grow(mesh, self.goals.vertices(), RINGS);
        let shape = Shape::of(mesh, frame);
        let body = Body { mesh, frame, shape: &shape, domain: &self.domain, memory: 0.0 };
        if !self.solver.solve(&body, STIFFNESS, TOLERATED, &self.goals, false) {
            return;
        }
        let largest = self.solver.motion.iter().map(Vector3::norm).fold(0.0, f64::max);
        let part = if largest > LONGEST * edge_length_m { LONGEST * edge_length_m / largest } else { 1.0 };
        for (&vertex, &motion) in self.domain.vertices().iter().zip(&self.solver.motion) {
            if motion.iter().all(|value| value.is_finite()) {
                add(vertex, motion * part);
            }
        }
    }
}
