//! Edges keep their rest length.

use crate::mesh::{Cloth, Vec3};

/// A compliant distance constraint for each edge (Macklin, Müller and Chentanez 2016, equations 17 and 18).
#[derive(Clone, Debug)]
pub(super) struct Stretch {
    edges: Vec<[u32; 2]>,
    rest_lengths_m: Vec<f64>,
    compliance_m_n: f64,
}

impl Stretch {
    pub(super) fn new(cloth: &Cloth, stiffness_n_m: f64) -> Self {
        let edges = cloth.edges();
        let rest_lengths_m = edges.iter().map(|&edge| cloth.rest_length(edge)).collect();
        Self { edges, rest_lengths_m, compliance_m_n: stiffness_n_m.recip() }
    }

    /// One sweep over all edges. With one iteration in each substep the multipliers start at zero and are not stored.
    pub(super) fn project(&self, positions: &mut [Vec3], inverse_masses: &[f64], substep_s: f64) {
        let compliance = self.compliance_m_n / (substep_s * substep_s);
        for (&[a, b], &rest_length) in self.edges.iter().zip(&self.rest_lengths_m) {
            let (a, b) = (a as usize, b as usize);
            let weight = inverse_masses[a] + inverse_masses[b];
            let along = positions[b] - positions[a];
            let length = along.norm();
            if weight <= 0.0 || length <= 0.0 {
                continue;
            }
            let multiplier = (length - rest_length) / (weight + compliance);
            let push = along * (multiplier / length);
            positions[a] += push * inverse_masses[a];
            positions[b] -= push * inverse_masses[b];
        }
    }
}
