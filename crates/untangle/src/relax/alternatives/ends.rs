//! Clean ends of attempts, and what each costs.

use nalgebra::{Point3, Vector3};

use crate::{
    geometry::mean_edge_length,
    relax::{
        constraints::ShapeLimits,
        energy::Domain,
        outcome::Iteration,
        relaxer::Relaxer,
        settle::{Pull, largest_strain},
    },
};

/// Strains up to this logarithm, of a tenth, are no loss.
const SMALL_STRAIN: f64 = 0.095;
/// Nor are faces that keep this part of their area.
const LARGE_AREA: f64 = 0.5;

/// What is within the limits is so up to this strain of rounding.
const ROUNDING: f64 = 1e-3;

/// A clean end of an attempt, its shape recovered.
#[derive(Clone)]
pub(in crate::relax) struct CleanEnd {
    pub(super) positions: Vec<Point3<f64>>,
    pub(super) history: Vec<Iteration>,
    largest_m: f64,
    /// As a part of the diagonal.
    mean: f64,
    /// The largest logarithm of an edge's length over that in the input.
    strain: f64,
    /// The least part of its area in the input that a face keeps.
    least_area: f64,
}

impl CleanEnd {
    pub(super) fn of(relaxer: &Relaxer<'_>) -> Self {
        let positions = relaxer.frame.positions().to_vec();
        Self {
            largest_m: relaxer.largest_displacement_m(),
            mean: mean_displacement(relaxer),
            strain: largest_strain(relaxer, &positions),
            least_area: relaxer.limits.least_area(relaxer.mesh, &positions),
            positions,
            history: relaxer.history.clone(),
        }
    }

    /// The mean displacement as a part of the diagonal.
    pub(in crate::relax) fn mean(&self) -> f64 {
        self.mean
    }

    /// Whether an edge or a face is beyond the limits of the descent.
    pub(super) fn is_beyond_limits(&self) -> bool {
        let ShapeLimits { max_stretch, min_area } = ShapeLimits::DESCENT;
        self.strain > libm::log(max_stretch) + ROUNDING || self.least_area < min_area
    }

    /// Whether it moves no more than another one, on the average and where it is farthest, and strains no edge and no
    /// face more: what costs less energy is no gain where it does.
    pub(super) fn is_no_loss_beside(&self, other: &Self) -> bool {
        self.mean <= other.mean
            && self.largest_m <= other.largest_m
            && self.strain <= other.strain.max(SMALL_STRAIN)
            && self.least_area >= other.least_area.min(LARGE_AREA)
    }
}

/// The mean distance of vertices from their places in the input, as a part of the diagonal.
pub(super) fn mean_displacement(relaxer: &Relaxer<'_>) -> f64 {
    let input = relaxer.rest.positions();
    let empty = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
    let (low, high) = input.iter().fold(empty, |(low, high), at| (low.inf(&at.coords), high.sup(&at.coords)));
    let moved_m: f64 = relaxer.frame.positions().iter().zip(input).map(|(now, before)| (now - before).norm()).sum();
    #[expect(clippy::cast_precision_loss, reason = "a count")]
    let count = input.len() as f64;
    moved_m / (count * (high - low).norm())
}

/// What an end costs: the energy that shape recovery lowers, the same one for all ends.
pub(super) struct Measure {
    pull: Pull,
    /// All free vertices.
    domain: Domain,
}

impl Measure {
    /// The pull towards the input is that for the end whose farthest vertex is nearest to its place there. Nothing
    /// without ends.
    pub(super) fn of(relaxer: &Relaxer<'_>, ends: &[CleanEnd]) -> Option<Self> {
        let Relaxer { mesh, frame, .. } = relaxer;
        let largest_m = ends.iter().map(|end| end.largest_m).min_by(f64::total_cmp)?;
        let is_free = |face: &_| mesh.face(*face).iter().any(|&corner| !mesh.is_pinned(corner));
        let edge_m = mean_edge_length(mesh, frame, mesh.face_ids().filter(is_free))?;
        let mut domain = Domain::default();
        domain.grow(mesh, mesh.vertex_ids(), 0);
        Some(Self { pull: Pull::of(largest_m, edge_m), domain })
    }

    pub(super) fn cost(&self, relaxer: &Relaxer<'_>, end: &CleanEnd) -> f64 {
        let Relaxer { mesh, frame, rest, .. } = relaxer;
        self.pull.energy(mesh, frame, rest, &self.domain).value(self.pull.stiffness, &end.positions)
    }
}
