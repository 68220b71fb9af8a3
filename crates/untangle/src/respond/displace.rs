//! Direct displacement: every vertex inside moves a part of the way to its target at once.
//!
//! Section 5.2 of Wicke, Lanker and Gross (2006). They move both sheets of pairs that have two regions; here the other sheet of a
//! one-sided pair moves towards the inside too, since half the way of one side alone only lengthens the path.

use nalgebra::Vector3;

use super::forces::mass_kg;
use crate::{
    correspond::{Correspondences, MaterialPoint, PathCorrespondence},
    frame::Frame,
    mesh::{Mesh, VertexId},
    respond::Corrections,
};

/// "Somewhat more than half" of the way.
const PART_OF_WAY: f64 = 0.6;

/// Weighted means of displacements, in metres.
#[derive(Debug, Default)]
pub(crate) struct Displacements {
    sums: Vec<Vector3<f64>>,
    weights: Vec<f64>,
    touched: Vec<VertexId>,
}

impl Displacements {
    /// Begins anew.
    pub(crate) fn start(&mut self, num_vertices: usize) {
        for vertex in self.touched.drain(..) {
            self.sums[vertex.index()] = Vector3::zeros();
            self.weights[vertex.index()] = 0.0;
        }
        self.sums.resize(num_vertices, Vector3::zeros());
        self.weights.resize(num_vertices, 0.0);
    }

    /// Adds the ways of one path; `offset_m` is half of the gap that shall be left, `two_sided` says that the corresponding path adds its own.
    pub(crate) fn follow(
        &mut self,
        frame: &Frame,
        found: &Correspondences,
        path: &PathCorrespondence,
        offset_m: f64,
        two_sided: bool,
    ) {
        for attraction in &found.attractions[path.attractions.clone()] {
            let way = attraction.target.position(frame) - attraction.source.position(frame);
            let distance = way.norm();
            if distance > 1e-9 * path.edge_length_m {
                let step = way * (PART_OF_WAY + 0.5 * offset_m / distance);
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
            let sum = &mut self.weights[vertex.index()];
            if *sum == 0.0 {
                self.touched.push(vertex);
            }
            *sum += part * weight;
            self.sums[vertex.index()] += step * (part * weight);
        }
    }

    /// Adds the means, as forces, to corrections.
    pub(crate) fn finish(&self, mesh: &Mesh, corrections: &mut Corrections) {
        for &vertex in self.touched.iter().filter(|&&vertex| !mesh.is_pinned(vertex)) {
            let weight = self.weights[vertex.index()];
            if weight > 0.0 {
                let mass = mass_kg(mesh, vertex);
                let force = &mut corrections.forces[vertex.index()];
                *force += self.sums[vertex.index()] * (mass / weight);
                if mass > 0.0 {
                    corrections.max_displacement_m = corrections.max_displacement_m.max(force.norm() / mass);
                }
            }
        }
    }
}
