//! The energy of the flattening flow: as rigid as possible for each triangle, plus a penalty on bending.
//!
//! Energy of positions `x`: `sum_f E_f(x) + b sum_i (h^2 / A_i) |(L x)_i|^2`, where `E_f` is the as-rigid-as-possible
//! energy of a triangle, with larger weights for small triangles, `L` the Laplacian of the cotangents alone, `A_i` the
//! area round a vertex and `h^2` its mean. The bending stiffness `b` is dimensionless: its root is the length, in
//! edges, below which bends are flattened. It is minimised by local and global steps in turn (Sorkine and Alexa 2007).
//! With rotations per vertex, as there, bending has a cost; with rotations per triangle it has none but that of `b`.

use faer::{
    MatMut,
    linalg::solvers::Solve,
    sparse::{SparseColMat, Triplet, linalg::solvers::Llt},
};
use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

use super::{domain::Domain, triangle_arap::RestTriangle};
use crate::{
    mesh::{Mesh, VertexId},
    relax::settings::ShouldStop,
};

/// Strained triangles are made stiffer by this factor each time.
const STIFFENING: f64 = 2.0;
/// Small triangles are as much stiffer as they are smaller than the mean, up to this factor.
const MAX_STIFFENING: f64 = 1000.0;
/// No vertex has less than this part of the mean area.
const MIN_AREA_RATIO: f64 = 0.2;
/// Local and global steps end when vertices move, in the mean square, by no more than this part of the distance between
/// them.
const CONVERGED: f64 = 0.003;
/// Holds what the energy leaves free, such as a translation of the whole.
const ANCHOR: f64 = 1e-4;

/// For one vertex: its neighbours and itself with the entries of the Laplacian's row.
type LaplacianRow = Vec<(VertexId, f64)>;

/// The energy of the triangles over a domain.
#[derive(Debug)]
pub(crate) struct FlatteningEnergy<'a> {
    domain: &'a Domain,
    triangles: Vec<RestTriangle>,
    /// One row for each vertex with a part in the bending, scaled by the root of `h^2 / A`.
    rows: Vec<LaplacianRow>,
    /// Root of the mean area round a vertex, in metres.
    spacing_m: f64,
}

/// The factorised system of the global step for one bending stiffness.
pub(crate) struct FlatteningSystem {
    factors: Llt<usize, f64>,
    /// What vertices that don't move, and holds, add to the right-hand side.
    fixed: Vec<Vector3<f64>>,
}

impl<'a> FlatteningEnergy<'a> {
    /// Takes the rest shape of all triangles of which a corner lies in the domain. `shape` has the position of each
    /// vertex of the mesh.
    pub(crate) fn of(mesh: &Mesh, domain: &'a Domain, shape: &[Point3<f64>]) -> Self {
        let mut triangles = Vec::new();
        let mut areas = vec![0.0; mesh.num_vertices()];
        let mut rows: Vec<LaplacianRow> = vec![Vec::new(); mesh.num_vertices()];
        for face in mesh.face_ids() {
            let corners = mesh.face(face);
            if mesh.face_edges(face).is_none() || corners.iter().all(|&vertex| domain.local(vertex).is_none()) {
                continue;
            }
            let triangle = RestTriangle::of(corners, corners.map(|vertex| shape[vertex.index()]));
            let area = triangle.rest_area();
            for (corner, vertex) in corners.into_iter().enumerate() {
                areas[vertex.index()] += area / 3.0;
                let (a, b) = (corners[(corner + 1) % 3], corners[(corner + 2) % 3]);
                for (from, to) in [(a, b), (b, a)] {
                    rows[from.index()].extend([(to, -triangle.weights[corner]), (from, triangle.weights[corner])]);
                }
            }
            triangles.push(triangle);
        }
        stiffen_small(&mut triangles);
        rows.retain(|row| !row.is_empty());
        #[expect(clippy::cast_precision_loss, reason = "a count of vertices")]
        let mean = areas.iter().sum::<f64>() / rows.len().max(1) as f64;
        for row in &mut rows {
            finish_row(row, &areas, mean);
        }
        Self { domain, triangles, rows, spacing_m: mean.sqrt() }
    }

    /// Factorises the system of the global step; nothing where the numbers don't allow it. `at` says where vertices are
    /// that don't move, and where others are held: those of the domain with the strength of their entry in `holds`, in
    /// units of the weights of their triangles; none without entries.
    pub(crate) fn factorise(&self, bending: f64, at: &[Point3<f64>], holds: &[f64]) -> Option<FlatteningSystem> {
        let mut system = Assembly::of(self.domain, at);
        for RestTriangle { corners, weights, .. } in &self.triangles {
            for (corner, &weight) in weights.iter().enumerate() {
                let (a, b) = (corners[(corner + 1) % 3], corners[(corner + 2) % 3]);
                for (row, col, value) in [(a, a, weight), (b, b, weight), (a, b, -weight), (b, a, -weight)] {
                    system.add(row, col, value);
                }
            }
        }
        for row in &self.rows {
            for &(first, a) in row {
                for &(second, b) in row {
                    system.add(first, second, bending * a * b);
                }
            }
        }
        system.hold(holds, &self.vertex_weights());
        system.factorise()
    }

    /// The sum of the triangles' weights at each vertex of the domain.
    fn vertex_weights(&self) -> Vec<f64> {
        let mut sums = vec![0.0; self.domain.vertices().len()];
        for RestTriangle { corners, weights, .. } in &self.triangles {
            for (corner, vertex) in corners.iter().enumerate() {
                if let Some(local) = self.domain.local(*vertex) {
                    sums[local] += weights[(corner + 1) % 3] + weights[(corner + 2) % 3];
                }
            }
        }
        sums
    }

    /// Makes local and global steps until they change little, or so many, or the work is to stop. Cost: for each of them one solution and a fit
    /// for each triangle.
    pub(crate) fn minimise(
        &self,
        system: &FlatteningSystem,
        max_steps: usize,
        positions: &mut [Point3<f64>],
        should_stop: &ShouldStop<'_>,
    ) {
        let size = self.domain.vertices().len();
        let mut right = vec![0.0; 3 * size];
        for _ in 0..max_steps {
            if should_stop() {
                break;
            }
            self.right_hand_side(system, positions, &mut right);
            system.factors.solve_in_place(MatMut::from_column_major_slice_mut(&mut right, size, 3));
            let mut change: f64 = 0.0;
            for (local, &vertex) in self.domain.vertices().iter().enumerate() {
                let place: Point3<f64> = [0, 1, 2].map(|axis| right[axis * size + local]).into();
                if place.iter().all(|value| value.is_finite()) {
                    change += (place - positions[vertex.index()]).norm_squared();
                    positions[vertex.index()] = place;
                }
            }
            #[expect(clippy::cast_precision_loss, reason = "a count of vertices")]
            if change <= size as f64 * (CONVERGED * self.spacing_m).powi(2) {
                break;
            }
        }
    }

    /// The local step: fits all triangles, and sums up the right-hand side of the global one, coordinate by coordinate.
    fn right_hand_side(&self, system: &FlatteningSystem, positions: &[Point3<f64>], right: &mut [f64]) {
        let size = self.domain.vertices().len();
        let forces: Vec<[Vector3<f64>; 3]> =
            self.triangles.par_iter().map(|triangle| triangle.corner_forces(positions)).collect();
        for (local, (&vertex, fixed)) in self.domain.vertices().iter().zip(&system.fixed).enumerate() {
            let sum = fixed + positions[vertex.index()].coords * ANCHOR;
            for axis in 0..3 {
                right[axis * size + local] = sum[axis];
            }
        }
        for (triangle, forces) in self.triangles.iter().zip(&forces) {
            for (vertex, force) in triangle.corners.iter().zip(forces) {
                if let Some(local) = self.domain.local(*vertex) {
                    for axis in 0..3 {
                        right[axis * size + local] += force[axis];
                    }
                }
            }
        }
    }

    /// Makes triangles stiffer that are strained or crushed.
    pub(crate) fn stiffen(&mut self, positions: &[Point3<f64>]) {
        for triangle in &mut self.triangles {
            if triangle.is_strained(positions) && triangle.stiffening < MAX_STIFFENING {
                triangle.stiffen(STIFFENING);
            }
        }
    }

    /// Mean square of the logarithms of all edges' lengths, triangle by triangle, over those at rest.
    pub(crate) fn mean_square_strain(&self, positions: &[Point3<f64>]) -> f64 {
        let (mut sum, mut count) = (0.0, 0.0);
        for strain in self.triangles.iter().flat_map(|triangle| triangle.strains(positions)) {
            sum += strain * strain;
            count += 1.0;
        }
        if count > 0.0 { sum / count } else { 0.0 }
    }
}

/// The lower half of a symmetric matrix over a domain, and its right-hand side.
struct Assembly<'a> {
    domain: &'a Domain,
    at: &'a [Point3<f64>],
    entries: Vec<Triplet<usize, usize, f64>>,
    fixed: Vec<Vector3<f64>>,
}

impl<'a> Assembly<'a> {
    fn of(domain: &'a Domain, at: &'a [Point3<f64>]) -> Self {
        let size = domain.vertices().len();
        let entries = (0..size).map(|local| Triplet { row: local, col: local, val: ANCHOR }).collect();
        Self { domain, at, entries, fixed: vec![Vector3::zeros(); size] }
    }

    /// Adds to an entry; those of vertices that don't move go to the right-hand side.
    fn add(&mut self, row: VertexId, col: VertexId, value: f64) {
        let Some(row) = self.domain.local(row) else { return };
        match self.domain.local(col) {
            Some(col) if col <= row => self.entries.push(Triplet { row, col, val: value }),
            Some(_) => {}
            None => self.fixed[row] -= self.at[col.index()].coords * value,
        }
    }

    /// Ties each vertex to where it is, with its entry in `holds` times its entry in `weights`.
    fn hold(&mut self, holds: &[f64], weights: &[f64]) {
        for (local, (hold, weight)) in holds.iter().zip(weights).enumerate() {
            let strength = hold * weight;
            self.entries.push(Triplet { row: local, col: local, val: strength });
            self.fixed[local] += self.at[self.domain.vertices()[local].index()].coords * strength;
        }
    }

    fn factorise(self) -> Option<FlatteningSystem> {
        let size = self.fixed.len();
        let matrix = SparseColMat::<usize, f64>::try_new_from_triplets(size, size, &self.entries).ok()?;
        Some(FlatteningSystem { factors: self.domain.factorise(&matrix)?, fixed: self.fixed })
    }
}

/// Makes small triangles stiffer: a part of a small triangle counts as much as the same part of a large one.
fn stiffen_small(triangles: &mut [RestTriangle]) {
    #[expect(clippy::cast_precision_loss, reason = "a count of triangles")]
    let mean = triangles.iter().map(RestTriangle::rest_area).sum::<f64>() / triangles.len().max(1) as f64;
    for triangle in triangles {
        let factor = (mean / triangle.rest_area()).clamp(1.0, MAX_STIFFENING);
        triangle.stiffen(if factor.is_nan() { 1.0 } else { factor });
    }
}

/// Sums up the entries of each vertex in a row of the Laplacian, and scales them by the root of `h^2 / A`.
fn finish_row(row: &mut LaplacianRow, areas: &[f64], mean_area: f64) {
    let own = row[1].0;
    row.sort_unstable_by_key(|&(vertex, _)| vertex);
    row.dedup_by(|next, kept| {
        let same = next.0 == kept.0;
        kept.1 += if same { next.1 } else { 0.0 };
        same
    });
    let scale = (areas[own.index()] / mean_area).max(MIN_AREA_RATIO).sqrt().recip();
    for (_, entry) in row {
        *entry *= if scale.is_finite() { scale } else { 1.0 };
    }
}
