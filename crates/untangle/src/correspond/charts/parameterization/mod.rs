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

use nalgebra::Complex;

use self::{arap::Arap, flat_faces::FlatFaces, lscm::ConformalMap};
use super::{patch::Patch, shapes::Shape, unfolding::Unfolding};

/// As-rigid-as-possible parameterisation, in memory that is kept from one patch to the next.
#[derive(Debug, Default)]
pub(super) struct ArapParameterization {
    parts: FlatFaces,
    scales: Vec<f64>,
    conformal: ConformalMap,
    arap: Arap,
    places: Vec<Complex<f64>>,
}

impl ArapParameterization {
    /// Replaces the places of an unfolding by those of a map with as little change of shape as possible. False, with
    /// the places untouched, where a system can't be solved. `has_one_scale` says that shapes have the same lengths
    /// along their common sides.
    ///
    /// Cost: two sparse factorisations, each for n vertices about O(n^1.5), and one solution for each iteration; linear
    /// for a patch of a given width.
    pub(super) fn flatten(
        &mut self,
        patch: &Patch,
        shapes: &[Shape],
        has_one_scale: bool,
        unfolding: &mut Unfolding,
    ) -> bool {
        if has_one_scale {
            self.scales.clear();
            self.scales.resize(shapes.len(), 1.0);
        } else {
            unfolding.scales(patch, shapes, &mut self.scales);
        }
        let is_solved = self.parts.take(patch, shapes, unfolding, &self.scales)
            && self.arap.factorise(&self.parts)
            && self.conformal.solve(&self.parts, &self.arap, &mut self.places)
            && self.arap.iterate(&self.parts, &mut self.places);
        if is_solved {
            self.parts.give_back(&self.places, unfolding);
        }
        is_solved
    }
}
