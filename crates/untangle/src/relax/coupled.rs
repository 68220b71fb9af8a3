//! The coupled response of one frame: one displacement that resolves all paths together, without trials or history.

use nalgebra::Vector3;

use super::{
    constraints::{ConstraintSource, Constraints, Objective, Orientation, collect},
    energy::{ArapEnergy, Domain, RestShape},
    step::{DisplacementSolver, Start},
};
use crate::{
    analysis::Analysis,
    correspond::Correspondences,
    frame::Frame,
    geometry::mean_edge_length,
    mesh::{Mesh, VertexId},
};

/// Width of the k-ring round the constraints that may move.
const COUPLED_RINGS: usize = 10;
/// The root of this is the length, in edges, over which a displacement decays.
const STIFFNESS: f64 = 16.0;
/// Edges that change their length by more than this factor are made stiffer.
const MAX_STRETCH: f64 = 1.2;
/// Longest displacement of one frame, in mean edge lengths.
const MAX_LENGTH: f64 = 6.0;

/// Finds coupled displacements, reusing its memory from frame to frame.
#[derive(Debug, Default)]
pub struct CoupledStep {
    orientation: Option<Orientation>,
    domain: Domain,
    constraints: Constraints,
    solver: DisplacementSolver,
}

impl CoupledStep {
    /// Finds the displacement for one frame of the mesh that this was first used with, and calls `add` with each vertex
    /// that moves and its displacement in metres. Pinned vertices don't move. Nothing where nothing intersects.
    ///
    /// The least change of the present shape, as rigid as possible, that takes every point inside to the other side of
    /// the sheet it penetrated, and makes paths without an inside shorter. Paths that are marked as cut off by a
    /// deadline have no constraints. Momentum is not kept.
    ///
    /// Cost: some factorisations of a sparse system over the vertices near the paths; it allocates, and no deadline
    /// ends it once begun.
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
        let source = ConstraintSource { mesh, frame, analysis, found, orientation };
        collect(&mut self.constraints, &source, Objective::Normal);
        if self.constraints.len() == 0 {
            return;
        }
        self.domain.grow(mesh, self.constraints.vertices(), COUPLED_RINGS);
        let rest = RestShape::of(mesh, frame);
        let energy =
            ArapEnergy { mesh, frame, rest: &rest, domain: &self.domain, rest_weight: 0.0, membrane: 0.0, anchor: 0.0 };
        if !self.solver.solve(&energy, STIFFNESS, MAX_STRETCH, &self.constraints, Start::Cold, &|| false) {
            return;
        }
        let largest = self.solver.displacement.iter().map(Vector3::norm).fold(0.0, f64::max);
        let limit = MAX_LENGTH * edge_length_m;
        let part = if largest > limit { limit / largest } else { 1.0 };
        for (&vertex, &displacement) in self.domain.vertices().iter().zip(&self.solver.displacement) {
            if displacement.iter().all(|value| value.is_finite()) {
                add(vertex, displacement * part);
            }
        }
    }
}
