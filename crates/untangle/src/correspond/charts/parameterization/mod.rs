//! Parameterisation of patches that don't unfold: conformal start, then as rigid as possible.
//!
//! Two sparse linear systems: [least-squares conformal maps](lscm) give a start without folds also for an annulus,
//! which an unfolding tears; then the local-global iteration of [ARAP](arap) restores the lengths. Weights are
//! cotangents of the shapes, kept positive so that the systems stay definite.

mod arap;
mod flat_faces;
mod lscm;
#[cfg(test)]
mod tests;

use self::{arap::Arap, flat_faces::FlatFaces, lscm::ConformalMap};
use super::{patch::Patch, shapes::Shape, unfolding::Unfolding};

/// As-rigid-as-possible parameterisation, in memory that is kept from one patch to the next.
#[derive(Debug, Default)]
pub(super) struct ArapParameterization {
    parts: FlatFaces,
    scales: Vec<f64>,
    conformal: ConformalMap,
    arap: Arap,
}

impl ArapParameterization {
    /// Replaces the places of an unfolding by those of a map with as little change of shape as possible. False, with
    /// the places untouched, where a system can't be solved.
    ///
    /// Cost: two sparse factorisations, each for n vertices about O(n^1.5), and one solution for each iteration.
    pub(super) fn flatten(&mut self, patch: &Patch, shapes: &[Shape], unfolding: &mut Unfolding) -> bool {
        unfolding.scales(patch, shapes, &mut self.scales);
        self.parts.take(patch, shapes, unfolding, &self.scales);
        let points = &mut unfolding.points;
        let is_solved = !self.parts.faces.is_empty()
            && self.arap.factorise(&self.parts)
            && self.conformal.solve(&self.parts, &self.arap, points)
            && self.arap.iterate(&self.parts, points);
        if !is_solved {
            points.copy_from_slice(&self.parts.start);
        }
        is_solved
    }
}
