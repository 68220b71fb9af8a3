//! Steps of the descent, made within its strain limits.

use nalgebra::{Point3, Vector3};

use crate::relax::{
    constraints::ShapeLimits,
    energy::ArapEnergy,
    step::{Backtracking, Damping, Islands, stored},
};

/// Backtracking of vertices beyond a limit.
const BACKTRACKING: Backtracking = Backtracking { halvings: 2, stops: 4 };
/// How often the step of an island is halved where that does not help, before it is left out.
const MAX_SCALINGS: usize = 4;

/// A step that is made within the limits, with its memory.
#[derive(Debug, Default)]
pub(super) struct LimitedStep {
    damping: Damping,
    violated: Vec<usize>,
    scales: Vec<f64>,
}

impl LimitedStep {
    /// Moves the vertices of the domain by a displacement each, or less far, and puts all positions into `out`. Where
    /// damping does not help, the whole island moves less far.
    pub(super) fn make(
        &mut self,
        energy: ArapEnergy<'_>,
        islands: &Islands,
        displacement: &[Vector3<f64>],
        single_precision: bool,
        out: &mut Vec<Point3<f64>>,
    ) {
        self.scales.clear();
        self.scales.resize(islands.len() + 1, 1.0);
        for attempt in 1.. {
            if self.make_damped(energy, islands, displacement, single_precision, out) {
                return;
            }
            let vertices = energy.domain.vertices();
            let mut is_over = vec![false; self.scales.len()];
            for &local in &self.violated {
                is_over[islands.of(vertices[local])] = true;
            }
            let mut is_any_moving = false;
            for (scale, _) in self.scales.iter_mut().zip(is_over).filter(|(_, is_over)| *is_over) {
                is_any_moving |= *scale > 0.0;
                *scale = if attempt < MAX_SCALINGS { 0.5 * *scale } else { 0.0 };
            }
            if !is_any_moving {
                // Only the rounding to single precision is left.
                return;
            }
        }
    }

    /// Moves by a part of the displacement for each island, damped round vertices beyond their limits. False where some
    /// stay beyond them.
    fn make_damped(
        &mut self,
        energy: ArapEnergy<'_>,
        islands: &Islands,
        displacement: &[Vector3<f64>],
        single_precision: bool,
        out: &mut Vec<Point3<f64>>,
    ) -> bool {
        let ArapEnergy { mesh, frame, domain, rest, .. } = energy;
        let vertices = domain.vertices();
        let before = frame.positions();
        out.clear();
        out.extend_from_slice(before);
        self.damping.reset(vertices.len());
        for round in 0..=BACKTRACKING.num_rounds() {
            for (local, &vertex) in vertices.iter().enumerate() {
                let part = self.damping.factor(local) * self.scales[islands.of(vertex)];
                let point = before[vertex.index()] + displacement[local] * part;
                out[vertex.index()] = stored(point, single_precision);
            }
            self.violated.clear();
            let is_violated = |vertex| ShapeLimits::DESCENT.are_violated(mesh, rest, before, out, vertex);
            self.violated.extend((0..vertices.len()).filter(|&local| is_violated(vertices[local])));
            if self.violated.is_empty() {
                return true;
            }
            self.damping.damp(mesh, domain, self.violated.iter().copied(), BACKTRACKING.factor(round));
        }
        false
    }
}
