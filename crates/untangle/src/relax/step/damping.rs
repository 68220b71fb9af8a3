//! Damping: displacements are scaled down at some vertices, and less and less in the k-ring round them.

use crate::{mesh::Mesh, relax::energy::Domain};

/// Width of the k-ring over which the damping fades out.
const DAMPED_RINGS: u32 = 6;

/// How a step backtracks: damped vertices get half of their factor in each of so many rounds, and then none in so many
/// more.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Backtracking {
    pub(crate) halvings: usize,
    pub(crate) stops: usize,
}

impl Backtracking {
    /// The number of rounds.
    pub(crate) fn num_rounds(self) -> usize {
        self.halvings + self.stops
    }

    /// The factor of a round.
    pub(crate) fn factor(self, round: usize) -> f64 {
        if round < self.halvings { 0.5 } else { 0.0 }
    }
}

/// For each vertex of a domain the part of its displacement that it makes.
#[derive(Debug, Default)]
pub(crate) struct Damping {
    factors: Vec<f64>,
    front: Vec<usize>,
}

impl Damping {
    /// Lets `size` vertices make all of their displacement.
    pub(crate) fn reset(&mut self, size: usize) {
        self.factors.clear();
        self.factors.resize(size, 1.0);
    }

    pub(crate) fn factor(&self, local: usize) -> f64 {
        self.factors[local]
    }

    /// Damps the displacement of some vertices by a factor, and round them as much as it takes to be smooth.
    pub(crate) fn damp(&mut self, mesh: &Mesh, domain: &Domain, locals: impl Iterator<Item = usize>, factor: f64) {
        self.front.clear();
        self.front.extend(locals);
        for &local in &self.front {
            self.factors[local] *= factor;
        }
        let mut first = 0;
        for _ in 0..DAMPED_RINGS {
            let last = self.front.len();
            for index in first..last {
                let local = self.front[index];
                let allowed = self.factors[local] + 1.0 / f64::from(DAMPED_RINGS);
                let vertex = domain.vertices()[local];
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

    /// Stops all vertices for which `is_stopped` holds. False if none of them moved.
    pub(crate) fn stop(&mut self, is_stopped: impl Fn(usize) -> bool) -> bool {
        let mut any = false;
        for (local, factor) in self.factors.iter_mut().enumerate() {
            if is_stopped(local) {
                any |= *factor > 0.0;
                *factor = 0.0;
            }
        }
        any
    }
}
