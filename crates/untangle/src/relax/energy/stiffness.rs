//! The quadratic part of the ARAP energy as a sparse matrix with its Cholesky factors.

use nalgebra::Vector3;

use super::vertex_arap::ArapEnergy;
use crate::correspond::{Cholesky, SparseSymmetric};

/// `A = 1 + s L` over the domain, where `L` is the Laplacian of the edges' weights; the same for the three coordinates.
pub(crate) struct StiffnessMatrix {
    factors: Cholesky,
    /// For each vertex of the domain where its row ends.
    row_ends: Vec<u32>,
    /// Neighbours within the domain, with the weights of their edges.
    neighbours: Vec<(u32, f64)>,
    diagonal: Vec<f64>,
}

impl StiffnessMatrix {
    /// Assembles and factorises; nothing where the numbers don't allow it. `stiffening` makes edges stiffer, one factor
    /// for each edge of the mesh.
    pub(crate) fn factorise(energy: &ArapEnergy<'_>, stiffness: f64, stiffening: &[f64]) -> Option<Self> {
        let size = energy.domain.vertices().len();
        let (mut row_ends, mut neighbours, mut diagonal) = (Vec::with_capacity(size), Vec::new(), Vec::new());
        let mut matrix = SparseSymmetric::default();
        matrix.start(size);
        for (local, &vertex) in energy.domain.vertices().iter().enumerate() {
            let mut sum = 1.0;
            for &edge in energy.mesh.vertex_edges(vertex) {
                let weight = stiffness * energy.rest.weight(edge) * stiffening[edge.index()];
                sum += weight;
                if let Some(other) = energy.domain.local(energy.mesh.opposite_vertex(edge, vertex)) {
                    neighbours.push((u32::try_from(other).ok()?, weight));
                    matrix.add(local, other, -weight);
                }
            }
            matrix.add(local, local, sum);
            diagonal.push(sum);
            row_ends.push(u32::try_from(neighbours.len()).ok()?);
        }
        matrix.compress();
        Some(Self { factors: energy.domain.factorise(&matrix)?, row_ends, neighbours, diagonal })
    }

    /// `A^-1 v`, in place, for all three coordinates.
    pub(crate) fn solve(&self, vectors: &mut [Vector3<f64>], scratch: &mut Vec<Vector3<f64>>) {
        self.factors.solve_vectors(vectors, scratch);
    }

    /// `A v`.
    pub(crate) fn multiply(&self, vectors: &[Vector3<f64>], out: &mut [Vector3<f64>]) {
        let mut start = 0;
        for (local, &end) in self.row_ends.iter().enumerate() {
            let mut sum = vectors[local] * self.diagonal[local];
            for &(other, weight) in &self.neighbours[start..end as usize] {
                sum -= vectors[other as usize] * weight;
            }
            out[local] = sum;
            start = end as usize;
        }
    }
}
