//! Cloth that keeps the shape of each of its triangles and wants to be flat: what straightens a crumple.
//!
//! Energy of positions `x`: `sum_f sum_k w_fk |e_fk - R_f q_fk|^2 + b sum_i (h^2 / A_i) |(L x)_i|^2`, where `q` are the edges of a triangle in
//! the input, laid into a plane, `R_f` the 3 x 2 matrix with orthonormal columns that fits them best to the present edges `e`, `w` cotangents
//! (Pinkall and Polthier 1993), larger for small triangles, `L` the Laplacian of the cotangents alone, `A_i` the area round a vertex and `h^2` its
//! mean. `b` is dimensionless: its root is the length, in edges, below which bends are drawn flat. Local and global steps in turn, as for shapes that are as rigid as
//! possible (Sorkine and Alexa 2007); unlike there, a bend by itself costs nothing but `b`.

use faer::{
    MatMut,
    linalg::solvers::Solve,
    sparse::{SparseColMat, Triplet, linalg::solvers::Llt},
};
use nalgebra::{Matrix2, Matrix3x2, Point3, Vector2, Vector3};
use rayon::prelude::*;

use super::domain::Domain;
use crate::mesh::{Mesh, VertexId};

/// Cotangents are limited to this and its inverse.
const SMALLEST_WEIGHT: f64 = 0.2;
/// Triangles whose sides change their length by more than this factor, or that keep less than this part of their area (thin ones may, with
/// sides that hardly change), are made stiffer, each time by the other factor.
const TOLERATED: f64 = 1.5;
const TOLERATED_AREA: f64 = 0.5;
const STIFFENING: f64 = 2.0;
/// Small triangles are as much stiffer as they are smaller than the mean, up to this factor.
const LARGEST_EMPHASIS: f64 = 1000.0;
/// No vertex has less than this part of the mean area.
const SMALLEST_AREA: f64 = 0.2;
/// Passes end when vertices move, in the mean square, by no more than this part of the distance between them.
const SETTLED: f64 = 0.003;
/// Holds what the energy leaves free, such as a motion of the whole.
const ANCHOR: f64 = 1e-4;

/// A triangle: for each side, opposite to a corner, its vector in the plane and its weight.
#[derive(Debug)]
struct Element {
    corners: [VertexId; 3],
    sides: [Vector2<f64>; 3],
    weights: [f64; 3],
    /// By what the weights are larger than the cotangents.
    emphasis: f64,
}

/// The triangles over a domain.
#[derive(Debug)]
pub(super) struct Membrane<'a> {
    domain: &'a Domain,
    elements: Vec<Element>,
    /// For each vertex with a part in the bending: its neighbours with the entries of the Laplacian's row, scaled by the root of `h^2 / A`.
    rows: Vec<Vec<(VertexId, f64)>>,
    /// Root of the mean area round a vertex, in metres.
    spacing_m: f64,
}

/// The factorised system for one bending stiffness.
pub(super) struct Factors {
    factors: Llt<usize, f64>,
    /// What vertices that don't move add to the right-hand side.
    fixed: Vec<Vector3<f64>>,
}

impl<'a> Membrane<'a> {
    /// Takes the shape of all triangles of which a corner lies in the domain.
    pub(super) fn of(mesh: &'a Mesh, domain: &'a Domain, shape: &[Point3<f64>]) -> Self {
        let mut elements = Vec::new();
        let mut areas = vec![0.0; mesh.num_vertices()];
        let mut rows: Vec<Vec<(VertexId, f64)>> = vec![Vec::new(); mesh.num_vertices()];
        for face in mesh.face_ids() {
            let corners = mesh.face(face);
            if mesh.face_edges(face).is_none() || corners.iter().all(|&vertex| domain.local(vertex).is_none()) {
                continue;
            }
            let element = Element::of(corners, corners.map(|vertex| shape[vertex.index()]));
            let area = element.area();
            for (corner, vertex) in corners.into_iter().enumerate() {
                areas[vertex.index()] += area / 3.0;
                let (a, b) = (corners[(corner + 1) % 3], corners[(corner + 2) % 3]);
                for (from, to) in [(a, b), (b, a)] {
                    rows[from.index()].extend([(to, -element.weights[corner]), (from, element.weights[corner])]);
                }
            }
            elements.push(element);
        }
        // A part of a small triangle counts as much as the same part of a large one.
        #[expect(clippy::cast_precision_loss, reason = "a count of triangles")]
        let mean = elements.iter().map(Element::area).sum::<f64>() / elements.len().max(1) as f64;
        for element in &mut elements {
            let emphasis = (mean / element.area()).clamp(1.0, LARGEST_EMPHASIS);
            element.emphasise(if emphasis.is_nan() { 1.0 } else { emphasis });
        }
        rows.retain(|row| !row.is_empty());
        #[expect(clippy::cast_precision_loss, reason = "a count of vertices")]
        let mean = areas.iter().sum::<f64>() / rows.len().max(1) as f64;
        for row in &mut rows {
            let own = row[1].0;
            row.sort_unstable_by_key(|&(vertex, _)| vertex);
            row.dedup_by(|next, kept| {
                let same = next.0 == kept.0;
                kept.1 += if same { next.1 } else { 0.0 };
                same
            });
            let scale = (areas[own.index()] / mean).max(SMALLEST_AREA).sqrt().recip();
            for (_, entry) in row {
                *entry *= if scale.is_finite() { scale } else { 1.0 };
            }
        }
        Self { domain, elements, rows, spacing_m: mean.sqrt() }
    }

    /// Factorises; nothing where the numbers don't allow it. `at` says where vertices are that don't move, and where others are held: those of
    /// the domain with the strength of their entry in `holds`, in units of what their triangles hold them with; none without entries.
    pub(super) fn factorise(&self, bending: f64, at: &[Point3<f64>], holds: &[f64]) -> Option<Factors> {
        let size = self.domain.vertices().len();
        let mut fixed = vec![Vector3::zeros(); size];
        let mut own = vec![0.0; size];
        let mut entries: Vec<_> = (0..size).map(|slot| Triplet { row: slot, col: slot, val: ANCHOR }).collect();
        let mut add = |row: VertexId, col: VertexId, value: f64| {
            let Some(row) = self.domain.local(row) else { return };
            match self.domain.local(col) {
                Some(col) if col <= row => entries.push(Triplet { row, col, val: value }),
                Some(_) => {}
                None => fixed[row] -= at[col.index()].coords * value,
            }
        };
        for Element { corners, weights, .. } in &self.elements {
            for (corner, &weight) in weights.iter().enumerate() {
                let (a, b) = (corners[(corner + 1) % 3], corners[(corner + 2) % 3]);
                for (row, col, value) in [(a, a, weight), (b, b, weight), (a, b, -weight), (b, a, -weight)] {
                    add(row, col, value);
                }
            }
        }
        for Element { corners, weights, .. } in &self.elements {
            for (corner, vertex) in corners.iter().enumerate() {
                if let Some(slot) = self.domain.local(*vertex) {
                    own[slot] += weights[(corner + 1) % 3] + weights[(corner + 2) % 3];
                }
            }
        }
        for row in &self.rows {
            for &(first, a) in row {
                for &(second, b) in row {
                    add(first, second, bending * a * b);
                }
            }
        }
        for (slot, (hold, own)) in holds.iter().zip(&own).enumerate() {
            let strength = hold * own;
            entries.push(Triplet { row: slot, col: slot, val: strength });
            fixed[slot] += at[self.domain.vertices()[slot].index()].coords * strength;
        }
        let matrix = SparseColMat::<usize, f64>::try_new_from_triplets(size, size, &entries).ok()?;
        Some(Factors { factors: self.domain.factorise(&matrix)?, fixed })
    }

    /// Makes local and global steps until they change little, or so many. Cost: for each of them one solution and a fit for each triangle.
    pub(super) fn relax(&self, factors: &Factors, most_passes: usize, positions: &mut [Point3<f64>]) {
        let vertices = self.domain.vertices();
        let mut right = vec![0.0; 3 * vertices.len()];
        for _ in 0..most_passes {
            let pulls: Vec<[Vector3<f64>; 3]> =
                self.elements.par_iter().map(|element| element.pulls(positions)).collect();
            for (slot, (&vertex, fixed)) in vertices.iter().zip(&factors.fixed).enumerate() {
                let sum = fixed + positions[vertex.index()].coords * ANCHOR;
                for axis in 0..3 {
                    right[axis * vertices.len() + slot] = sum[axis];
                }
            }
            for (element, pulls) in self.elements.iter().zip(&pulls) {
                for (vertex, pull) in element.corners.iter().zip(pulls) {
                    if let Some(slot) = self.domain.local(*vertex) {
                        for axis in 0..3 {
                            right[axis * vertices.len() + slot] += pull[axis];
                        }
                    }
                }
            }
            factors.factors.solve_in_place(MatMut::from_column_major_slice_mut(&mut right, vertices.len(), 3));
            let mut change: f64 = 0.0;
            for (slot, &vertex) in vertices.iter().enumerate() {
                let place: Point3<f64> = [0, 1, 2].map(|axis| right[axis * vertices.len() + slot]).into();
                if place.iter().all(|value| value.is_finite()) {
                    change += (place - positions[vertex.index()]).norm_squared();
                    positions[vertex.index()] = place;
                }
            }
            #[expect(clippy::cast_precision_loss, reason = "a count of vertices")]
            if change <= vertices.len() as f64 * (SETTLED * self.spacing_m).powi(2) {
                break;
            }
        }
    }

    /// Makes triangles stiffer that are strained or crushed.
    pub(super) fn stiffen(&mut self, positions: &[Point3<f64>]) {
        for element in &mut self.elements {
            let strained = element.strains(positions).any(|strain| strain.abs() > TOLERATED.ln());
            if (strained || element.is_crushed(positions)) && element.emphasis < LARGEST_EMPHASIS {
                element.emphasise(STIFFENING);
            }
        }
    }

    /// Mean square of the logarithms of all triangles' sides over those in the input.
    pub(super) fn strain(&self, positions: &[Point3<f64>]) -> f64 {
        let (mut sum, mut count) = (0.0, 0.0);
        for strain in self.elements.iter().flat_map(|element| element.strains(positions)) {
            sum += strain * strain;
            count += 1.0;
        }
        if count > 0.0 { sum / count } else { 0.0 }
    }
}

impl Element {
    fn of(corners: [VertexId; 3], at: [Point3<f64>; 3]) -> Self {
        let (along, other) = (at[1] - at[0], at[2] - at[0]);
        let length = along.norm();
        let across = if length > 0.0 { along.dot(&other) / length } else { 0.0 };
        let height = (other.norm_squared() - across * across).max(0.0).sqrt();
        let flat = [Vector2::zeros(), Vector2::new(length, 0.0), Vector2::new(across, height)];
        let weights = [0, 1, 2].map(|k| {
            let (a, b) = (flat[(k + 1) % 3] - flat[k], flat[(k + 2) % 3] - flat[k]);
            let cotangent = a.dot(&b) / a.perp(&b).abs();
            if cotangent.is_nan() { 1.0 } else { cotangent.clamp(SMALLEST_WEIGHT, 1.0 / SMALLEST_WEIGHT) }
        });
        Self { corners, sides: [0, 1, 2].map(|k| flat[(k + 2) % 3] - flat[(k + 1) % 3]), weights, emphasis: 1.0 }
    }

    fn emphasise(&mut self, factor: f64) {
        self.emphasis *= factor;
        for weight in &mut self.weights {
            *weight *= factor;
        }
    }

    /// The logarithms of its sides' lengths over those in the input; without those that have none.
    fn strains<'a>(&'a self, positions: &'a [Point3<f64>]) -> impl Iterator<Item = f64> + 'a {
        let strains = self.sides.iter().enumerate().map(|(k, side)| {
            let [a, b] = [1, 2].map(|step| positions[self.corners[(k + step) % 3].index()]);
            ((b - a).norm() / side.norm()).ln()
        });
        strains.filter(|strain| strain.is_finite())
    }

    fn is_crushed(&self, positions: &[Point3<f64>]) -> bool {
        let [a, b, c] = self.corners.map(|vertex| positions[vertex.index()]);
        0.5 * (b - a).cross(&(c - a)).norm() < TOLERATED_AREA * self.area()
    }

    fn area(&self) -> f64 {
        0.5 * self.sides[0].perp(&self.sides[1]).abs()
    }

    /// What each corner adds to the right-hand side: the sides as the triangle would have them where it is.
    fn pulls(&self, positions: &[Point3<f64>]) -> [Vector3<f64>; 3] {
        let at = self.corners.map(|vertex| positions[vertex.index()]);
        let mut sum = Matrix3x2::zeros();
        for k in 0..3 {
            sum += (at[(k + 2) % 3] - at[(k + 1) % 3]) * self.sides[k].transpose() * self.weights[k];
        }
        let fit = nearest_orthonormal(&sum);
        let mut pulls = [Vector3::zeros(); 3];
        for k in 0..3 {
            let side = fit * self.sides[k] * self.weights[k];
            pulls[(k + 2) % 3] += side;
            pulls[(k + 1) % 3] -= side;
        }
        pulls
    }
}

/// The factor with orthonormal columns in a polar decomposition; zero for a matrix without a direction.
fn nearest_orthonormal(matrix: &Matrix3x2<f64>) -> Matrix3x2<f64> {
    let square = matrix.transpose() * matrix;
    let (root, trace) = (square.determinant().max(0.0).sqrt(), square.trace());
    if root > 1e-9 * trace {
        // The inverse of the square root of a symmetric 2 x 2 matrix, by Cayley and Hamilton.
        let root_of_trace = (trace + 2.0 * root).sqrt();
        let inverse = (Matrix2::identity() * (trace + root) - square) / (root * root_of_trace);
        return matrix * inverse;
    }
    let svd = matrix.svd(true, true);
    match (svd.u, svd.v_t) {
        (Some(u), Some(v_t)) if (u * v_t).iter().all(|value| value.is_finite()) => u * v_t,
        _ => Matrix3x2::zeros(),
    }
}
