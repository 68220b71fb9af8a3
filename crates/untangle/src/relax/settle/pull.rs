//! How strongly places and shapes are drawn back to those of the input.

use crate::{
    frame::Frame,
    mesh::Mesh,
    relax::energy::{ArapEnergy, Domain, RestShape},
};

/// Most weight of the elastic energy beside the step: its root is the length, in edges, over which a displacement
/// decays. Where a weaker pull is enough for the strain below, the pull gets weaker and not this larger.
const MAX_STIFFNESS: f64 = 1280.0;
/// Least weight, for displacements far below an edge.
const MIN_STIFFNESS: f64 = 16.0;
/// The part of it that keeps lengths of edges only.
const MEMBRANE: f64 = 0.98;
/// Strain that the pull towards the input may cost: the largest displacement is spread over a length of which it is
/// this part.
const STRAIN: f64 = 0.03;

/// Weights of places and shapes.
#[derive(Clone, Copy, Debug)]
pub(in crate::relax) struct Pull {
    /// Of shapes.
    pub(in crate::relax) stiffness: f64,
    /// Of places.
    anchor: f64,
}

impl Pull {
    /// That for vertices which are up to so far from their places.
    pub(in crate::relax) fn of(largest_m: f64, edge_length_m: f64) -> Self {
        let length_edges = largest_m / (STRAIN * edge_length_m);
        let square = (length_edges * length_edges).max(MIN_STIFFNESS);
        let stiffness = square.min(MAX_STIFFNESS);
        Self { stiffness, anchor: stiffness / square }
    }

    /// The energy of displacements of a domain from a state. Its value belongs to this stiffness.
    pub(in crate::relax) fn energy<'a>(
        self,
        mesh: &'a Mesh,
        frame: &'a Frame,
        rest: &'a RestShape,
        domain: &'a Domain,
    ) -> ArapEnergy<'a> {
        ArapEnergy { mesh, frame, rest, domain, rest_weight: 1.0, membrane: MEMBRANE, anchor: self.anchor }
    }
}
