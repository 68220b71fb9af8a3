//! The force law: how far one step takes a point, by how far it has to go and how deep its tangle is.

use nalgebra::Vector3;

use crate::settings::{DEFAULT_MAX_STEP_EDGE_LENGTHS as DEFAULT_STEP, Settings};

/// What stands in for a thickness that is not set is at least this part of the depth of the tangle. With the edges
/// alone the rim of a deep region lags behind on fine meshes: two scenes of `host_table` took twice the steps with
/// edges of a quarter; twice as much changed nothing.
const THICKNESS_PER_DEPTH: f64 = 0.2;

/// A push over a boundary takes this many times the steps of an attraction. It takes whole sheets along and does not
/// slow down as they arrive: of 1, 1.4, 1.7 and 2, tried on the scenes of `host_table`, 1 and 1.4 threw sheets into new
/// tangles.
const STEPS_OF_PUSH: f64 = 5.0 / 3.0;

/// The law that turns a distance into a displacement of one step, for one path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ForceLaw {
    /// Part of the distance that one step covers.
    pub(crate) stiffness: f64,
    /// Half of the gap that shall be left between the sheets, in metres.
    pub(crate) offset_m: f64,
    /// Largest displacement of one step, in metres.
    pub(crate) largest_m: f64,
}

impl ForceLaw {
    /// The law for a path through faces of a mean edge length, in a tangle in which something has to go `depth_m` far:
    /// that of the edges where they are longer than the tangle is deep, and that of the tangle elsewhere.
    ///
    /// A constant force that displaces by `2 depth / n^2` a step moves what was at rest by `depth` in `n` steps,
    /// whatever the edges are. The limit is that for the default of `max_step_edge_lengths`.
    pub(crate) fn new(settings: &Settings, edge_length_m: f64, depth_m: f64) -> Self {
        let from_depth_m = 2.0 * depth_m / (DEFAULT_STEP * settings.steps_to_clean.powi(2));
        let largest_m = settings.max_step_edge_lengths * edge_length_m.max(from_depth_m);
        let offset_m = settings.thickness_m.unwrap_or_else(|| edge_length_m.max(THICKNESS_PER_DEPTH * depth_m)) * 0.5;
        Self { stiffness: settings.stiffness_per_step2, offset_m, largest_m }
    }

    /// The law for a push over a boundary that is `depth_m` away: as above, over more steps.
    pub(crate) fn of_push(settings: &Settings, edge_length_m: f64, depth_m: f64) -> Self {
        Self::new(settings, edge_length_m, depth_m / STEPS_OF_PUSH.powi(2))
    }

    /// `min(k (d + o), f_max)`, in metres of displacement of one step.
    ///
    /// Equation 4 of Wicke, Lanker and Gross (2006) prints `max`; its text means `min`. Their law vanishes as the gap
    /// closes, where the stiffness of the cloth stalls it: hence the offset.
    pub(crate) fn step(&self, distance_m: f64) -> f64 {
        (self.stiffness * (distance_m + self.offset_m)).min(self.largest_m)
    }
}

/// A vector, shortened to a length if it is longer.
pub(crate) fn limited(vector: Vector3<f64>, largest: f64) -> Vector3<f64> {
    let size = vector.norm();
    if size > largest { vector * (largest / size) } else { vector }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn force_law_grows_from_offset_to_limit() {
        let law = ForceLaw { stiffness: 0.5, offset_m: 0.01, largest_m: 0.02 };
        assert!((law.step(0.0) - 0.005).abs() < 1e-15);
        assert!((law.step(0.01) - 0.01).abs() < 1e-15);
        assert!((law.step(7.0) - 0.02).abs() < 1e-15);
    }

    #[test]
    fn force_law_of_a_deep_tangle_does_not_know_the_edges_and_of_a_shallow_one_only_the_edges() {
        let settings = Settings::default();
        let law = |edge_m, depth_m| ForceLaw::new(&settings, edge_m, depth_m);
        let deep = law(0.01, 0.1).largest_m;
        assert!((deep - 2.0 * 0.1 / settings.steps_to_clean.powi(2)).abs() < 1e-15);
        for edge_m in [0.005, 0.0025] {
            assert_eq!(law(edge_m, 0.1), law(0.01, 0.1));
        }
        let shallow = ForceLaw { stiffness: 0.5, offset_m: 0.005, largest_m: 0.2 * 0.01 };
        for depth_m in [0.0, 0.005, 0.009] {
            assert_eq!(law(0.01, depth_m), shallow);
        }
    }
}
