//! Motions that are held back where they would do harm, and from there outwards ever less.

use super::domain::Domain;
use crate::mesh::Mesh;

/// Rings over which the damping fades out.
const RINGS: u32 = 6;

/// For each vertex of a domain the part of its motion that it makes.
#[derive(Debug, Default)]
pub(super) struct Damping {
    factors: Vec<f64>,
    front: Vec<usize>,
}

impl Damping {
    /// Lets `size` vertices make all of their motion.
    pub(super) fn reset(&mut self, size: usize) {
        self.factors.clear();
        self.factors.resize(size, 1.0);
    }

    pub(super) fn factor(&self, slot: usize) -> f64 {
        self.factors[slot]
    }

    /// Damps the motion of some vertices by a factor, and round them as much as it takes to be smooth.
    pub(super) fn damp(&mut self, mesh: &Mesh, domain: &Domain, slots: impl Iterator<Item = usize>, factor: f64) {
        self.front.clear();
        self.front.extend(slots);
        for &slot in &self.front {
            self.factors[slot] *= factor;
        }
        let mut first = 0;
        for _ in 0..RINGS {
            let last = self.front.len();
            for index in first..last {
                let slot = self.front[index];
                let allowed = self.factors[slot] + 1.0 / f64::from(RINGS);
                let vertex = domain.vertices()[slot];
                for &edge in mesh.vertex_edges(vertex) {
                    if let Some(next) = domain.local(mesh.opposite_vertex(edge, vertex))
                        && self.factors[next] > allowed
                    {
                        self.factors[next] = allowed;
                        self.front.push(next);
                    }
                }
            }
            first = last;
        }
    }

    /// Stops the motion of all vertices for which `stays` holds.
    pub(super) fn stop(&mut self, stays: impl Fn(usize) -> bool) {
        for (slot, factor) in self.factors.iter_mut().enumerate() {
            if stays(slot) {
                *factor = 0.0;
            }
        }
    }
}
