//! The quadratic part of the ARAP energy as a sparse matrix with its Cholesky factors.

use faer::{
    MatMut,
    linalg::solvers::Solve,
    sparse::{SparseColMat, Triplet, linalg::solvers::Llt},
};
use nalgebra::Vector3;

use super::vertex_arap::ArapEnergy;

/// `A = 1 + s L` over the domain, where `L` is the Laplacian of the edges' weights; the same for the three coordinates.
pub(crate) struct StiffnessMatrix {
    factors: Llt<usize, f64>,
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
        let mut entries = Vec::new();
        for (local, &vertex) in energy.domain.vertices().iter().enumerate() {
            let mut sum = 1.0;
            for &edge in energy.mesh.vertex_edges(vertex) {
                let weight = stiffness * energy.rest.weight(edge) * stiffening[edge.index()];
                sum += weight;
                if let Some(other) = energy.domain.local(energy.mesh.opposite_vertex(edge, vertex)) {
                    neighbours.push((u32::try_from(other).ok()?, weight));
                    if other < local {
                        entries.push(Triplet { row: local, col: other, val: -weight });
                    }
                }
            }
            entries.push(Triplet { row: local, col: local, val: sum });
            diagonal.push(sum);
            row_ends.push(u32::try_from(neighbours.len()).ok()?);
        }
        let matrix = SparseColMat::<usize, f64>::try_new_from_triplets(size, size, &entries).ok()?;
        Some(Self { factors: energy.domain.factorise(&matrix)?, row_ends, neighbours, diagonal })
    }

    /// `A^-1 v`, in place, for all three coordinates.
    pub(crate) fn solve(&self, vectors: &mut [Vector3<f64>], scratch: &mut Vec<f64>) {
        let size = vectors.len();
        scratch.clear();
        for axis in 0..3 {
            scratch.extend(vectors.iter().map(|vector| vector[axis]));
        }
        self.factors.solve_in_place(MatMut::from_column_major_slice_mut(scratch, size, 3));
        for (index, vector) in vectors.iter_mut().enumerate() {
            for axis in 0..3 {
                vector[axis] = scratch[axis * size + index];
            }
        }
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
