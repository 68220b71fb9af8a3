//! Direct displacement: every vertex inside moves by a part of the distance to its target at once.
//!
//! Section 5.2 of Wicke, Lanker and Gross (2006). They move both sheets of pairs that have two regions; here the other
//! sheet of a one-sided pair moves towards the inside too, since half the distance on one side alone only lengthens the
//! path.

use nalgebra::Vector3;

use super::forces::mass_kg;
use crate::{
    correspond::{Correspondences, MaterialPoint, PathCorrespondence},
    frame::Frame,
    mesh::{Mesh, VertexId},
    respond::Corrections,
    sparse_map::SparseMap,
};

/// The part of the distance to the target: "somewhat more than half", says the paper.
const PART_OF_WAY: f64 = 0.6;

/// Weighted means of displacements, in metres, by vertex.
#[derive(Debug, Default)]
pub(crate) struct Displacements {
    sums: SparseMap<VertexId, WeightedSum>,
}

#[derive(Clone, Copy, Debug, Default)]
struct WeightedSum {
    sum: Vector3<f64>,
    weight: f64,
}

impl Displacements {
    /// Clears all displacements.
    pub(crate) fn reset(&mut self, num_vertices: usize) {
        self.sums.reset(num_vertices);
    }

    /// Adds the displacements of one path; `offset_m` is half of the gap that shall be left, `two_sided` says that the
    /// corresponding path adds its own.
    pub(crate) fn add_path(
        &mut self,
        frame: &Frame,
        found: &Correspondences,
        path: &PathCorrespondence,
        offset_m: f64,
        two_sided: bool,
    ) {
        for attraction in &found.attractions[path.attractions.clone()] {
            let displacement = attraction.target.position(frame) - attraction.source.position(frame);
            let distance = displacement.norm();
            if distance > 1e-9 * path.edge_length_m {
                let step = displacement * (PART_OF_WAY + 0.5 * offset_m / distance);
                self.add(&attraction.source, step, 1.0);
                if !two_sided {
                    self.add(&attraction.target, -step, 1.0);
                }
            }
        }
        for separation in &found.separations[path.separations.clone()] {
            let (step, weight) = (separation.direction * (0.5 * offset_m), separation.length_m / path.edge_length_m);
            self.add(&separation.own, step, weight);
            self.add(&separation.partner, -step, weight);
        }
    }

    fn add(&mut self, point: &MaterialPoint, step: Vector3<f64>, weight: f64) {
        for (&vertex, part) in point.vertices.iter().zip(point.weights).filter(|(_, part)| *part > 0.0) {
            let sum = self.sums.entry(vertex);
            sum.weight += part * weight;
            sum.sum += step * (part * weight);
        }
    }

    /// Adds the means, as forces, to corrections.
    pub(crate) fn finish(&self, mesh: &Mesh, corrections: &mut Corrections) {
        for &vertex in self.sums.keys().iter().filter(|&&vertex| !mesh.is_pinned(vertex)) {
            let WeightedSum { sum, weight } = self.sums.get(vertex).unwrap_or_default();
            if weight > 0.0 {
                let mass = mass_kg(mesh, vertex);
                let force = corrections.force_mut(vertex);
                *force += sum * (mass / weight);
                let size = force.norm();
                if mass > 0.0 {
                    corrections.max_displacement_m = corrections.max_displacement_m.max(size / mass);
                }
            }
        }
    }
}
