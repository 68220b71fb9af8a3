//! The shape that the cloth wants to keep: as rigid as possible (Sorkine and Alexa 2007), over the domain of one iteration.
//!
//! Energy of a motion `d` of the vertices: `1/2 sum |d_i|^2 + s/2 sum_ij w_ij |(y_i - y_j) - R_ij e_ij|^2` with `y = x + d`, edges `e` of the
//! present shape drawn a little towards those of the input, and for each vertex the rotation that fits its edges best. With the
//! rotations held the energy is quadratic and the same for the three coordinates. `s` is dimensionless: its root is the length, in
//! edges, over which a motion dies away.

use faer::{
    MatMut,
    linalg::solvers::Solve,
    sparse::{SparseColMat, Triplet, linalg::solvers::Llt},
};
use nalgebra::{Matrix3, Point3, Rotation3, Vector3};

use super::domain::Domain;
use crate::{
    frame::Frame,
    mesh::{EdgeId, Mesh, VertexId},
};

/// Weights of edges are cotangents, limited to this and its inverse.
const SMALLEST_WEIGHT: f64 = 0.2;
/// Newton's steps to a rotation: where they begin, how many there may be, and when the last was small enough.
const SMALLEST_DETERMINANT: f64 = 1e-3;
const MOST_STEPS: usize = 12;
const LAST_CHANGE: f64 = 1e-7;

/// Weights of all edges of a mesh and the shape of the input.
#[derive(Debug)]
pub(super) struct Shape {
    weights: Vec<f64>,
    positions: Vec<Point3<f64>>,
}

impl Shape {
    pub(super) fn of(mesh: &Mesh, frame: &Frame) -> Self {
        let mut weights = vec![0.0; mesh.num_edges()];
        for face in mesh.face_ids() {
            let Some(edges) = mesh.face_edges(face) else { continue };
            let corners = mesh.face(face).map(|vertex| frame.position(vertex));
            for (k, edge) in edges.into_iter().enumerate() {
                let (a, b) = (corners[k] - corners[(k + 2) % 3], corners[(k + 1) % 3] - corners[(k + 2) % 3]);
                let cotangent = a.dot(&b) / a.cross(&b).norm();
                weights[edge.index()] += 0.5 * if cotangent.is_finite() { cotangent } else { 0.0 };
            }
        }
        for weight in &mut weights {
            *weight = weight.clamp(SMALLEST_WEIGHT, 1.0 / SMALLEST_WEIGHT);
        }
        Self { weights, positions: frame.positions().to_vec() }
    }

    pub(super) fn weight(&self, edge: EdgeId) -> f64 {
        self.weights[edge.index()]
    }

    /// A position in the input.
    pub(super) fn position(&self, vertex: VertexId) -> Point3<f64> {
        self.positions[vertex.index()]
    }

    fn side(&self, from: VertexId, to: VertexId) -> Vector3<f64> {
        self.positions[to.index()] - self.positions[from.index()]
    }
}

/// The factorised quadratic part for one stiffness.
pub(super) struct Stiffness {
    factors: Llt<usize, f64>,
    /// For each vertex of the domain where its row ends.
    row_ends: Vec<u32>,
    /// Neighbours within the domain, with the weights of their edges.
    neighbours: Vec<(u32, f64)>,
    diagonal: Vec<f64>,
    stiffness: f64,
}

/// What the energy is measured on.
#[derive(Clone, Copy)]
pub(super) struct Body<'a> {
    pub(super) mesh: &'a Mesh,
    pub(super) frame: &'a Frame,
    pub(super) shape: &'a Shape,
    pub(super) domain: &'a Domain,
    /// How far present edges are drawn towards those of the input: 0 not, 1 all the way.
    pub(super) memory: f64,
}

impl Body<'_> {
    /// Length of an edge after a motion over that in the input.
    pub(super) fn stretch(&self, motion: &[Vector3<f64>], edge: EdgeId) -> f64 {
        let [a, b] = self.mesh.edge(edge);
        let moved = |vertex: VertexId| {
            let motion = self.domain.local(vertex).map_or_else(Vector3::zeros, |local| motion[local]);
            self.frame.position(vertex) + motion
        };
        (moved(b) - moved(a)).norm() / self.shape.side(a, b).norm()
    }
}

impl Stiffness {
    /// Factorises; nothing where the numbers don't allow it. `emphasis` makes edges stiffer, one factor for each edge of the mesh.
    pub(super) fn factorise(body: &Body<'_>, stiffness: f64, emphasis: &[f64]) -> Option<Self> {
        let size = body.domain.vertices().len();
        let (mut row_ends, mut neighbours, mut diagonal) = (Vec::with_capacity(size), Vec::new(), Vec::new());
        let mut entries = Vec::new();
        for (local, &vertex) in body.domain.vertices().iter().enumerate() {
            let mut sum = 1.0;
            for &edge in body.mesh.vertex_edges(vertex) {
                let weight = stiffness * body.shape.weight(edge) * emphasis[edge.index()];
                sum += weight;
                if let Some(other) = body.domain.local(body.mesh.opposite_vertex(edge, vertex)) {
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
        Some(Self { factors: body.domain.factorise(&matrix)?, row_ends, neighbours, diagonal, stiffness })
    }

    /// `A^-1 v`, in place, for all three coordinates.
    pub(super) fn solve(&self, vectors: &mut [Vector3<f64>], scratch: &mut Vec<f64>) {
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
    pub(super) fn multiply(&self, vectors: &[Vector3<f64>], out: &mut [Vector3<f64>]) {
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

    /// The force of the shape, at no motion, with the rotations that fit `motion`: the right-hand side.
    pub(super) fn force(
        &self,
        body: &Body<'_>,
        motion: &[Vector3<f64>],
        emphasis: &[f64],
        rotations: &mut Vec<[Matrix3<f64>; 2]>,
        out: &mut [Vector3<f64>],
    ) {
        let Body { mesh, frame, shape, domain, memory } = *body;
        let moved = |vertex: VertexId| domain.local(vertex).map_or_else(Vector3::zeros, |local| motion[local]);
        rotations.clear();
        rotations.extend(domain.vertices().iter().map(|&vertex| {
            let mut sums = [Matrix3::zeros(); 2];
            for &edge in mesh.vertex_edges(vertex) {
                let other = mesh.opposite_vertex(edge, vertex);
                let now = frame.position(other) - frame.position(vertex);
                let then = now + moved(other) - moved(vertex);
                sums[0] += then * now.transpose() * shape.weight(edge);
                sums[1] += then * shape.side(vertex, other).transpose() * shape.weight(edge);
            }
            // What has no weight below is not needed.
            let weights = [1.0 - memory, memory];
            [0, 1].map(|k| if weights[k] > 0.0 { nearest_rotation(&sums[k]) } else { Matrix3::identity() })
        }));
        for (local, &vertex) in domain.vertices().iter().enumerate() {
            let mut force = Vector3::zeros();
            for &edge in mesh.vertex_edges(vertex) {
                let other = mesh.opposite_vertex(edge, vertex);
                let there = rotations[domain.local(other).unwrap_or(local)];
                let now = frame.position(other) - frame.position(vertex);
                let wanted = (rotations[local][0] + there[0]) * now * (0.5 * (1.0 - memory))
                    + (rotations[local][1] + there[1]) * shape.side(vertex, other) * (0.5 * memory);
                // Pulls `vertex` to where the edge to `other` has the wanted shape.
                force += (now - wanted) * (self.stiffness * shape.weight(edge) * emphasis[edge.index()]);
            }
            out[local] = force;
        }
    }
}

/// The rotation nearest to a matrix; the identity for a matrix without any direction.
///
/// The matrices here come from sheets and are almost singular. The matrix of cofactors has the same singular vectors, and is large where they are
/// small: the sum of both has the same nearest rotation, and a condition that Newton's steps (Higham 1986) like. What they don't like is
/// left to the singular value decomposition, which takes several times as long.
fn nearest_rotation(matrix: &Matrix3<f64>) -> Matrix3<f64> {
    let scaled = matrix / matrix.norm();
    let mut rotation = scaled + cofactors(&scaled);
    for _ in 0..MOST_STEPS {
        let cofactors = cofactors(&rotation);
        let determinant = rotation.column(0).dot(&cofactors.column(0));
        if determinant.is_nan() || determinant < SMALLEST_DETERMINANT {
            break;
        }
        let scale = (cofactors.norm() / (determinant * rotation.norm())).sqrt();
        let next = rotation * (0.5 * scale) + cofactors * (0.5 / (scale * determinant));
        let change = (next - rotation).norm();
        rotation = next;
        // The error is the square of the last change.
        if change < LAST_CHANGE {
            return rotation;
        }
    }
    nearest_rotation_by_decomposition(matrix)
}

fn cofactors(matrix: &Matrix3<f64>) -> Matrix3<f64> {
    let [a, b, c] = [0, 1, 2].map(|column| matrix.column(column));
    Matrix3::from_columns(&[b.cross(&c), c.cross(&a), a.cross(&b)])
}

fn nearest_rotation_by_decomposition(matrix: &Matrix3<f64>) -> Matrix3<f64> {
    let svd = matrix.svd(true, true);
    let (Some(u), Some(vt)) = (svd.u, svd.v_t) else { return Matrix3::identity() };
    let mut rotation = u * vt;
    if rotation.determinant() < 0.0 {
        let mut flipped = u;
        flipped.column_mut(2).neg_mut();
        rotation = flipped * vt;
    }
    if rotation.iter().all(|value| value.is_finite()) { rotation } else { Rotation3::identity().into_inner() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};

    #[test]
    fn both_ways_to_the_nearest_rotation_agree() {
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(1);
        for thickness in [1.0, 1e-3, 1e-9, 0.0] {
            for _ in 0..200 {
                let mut unit = || random.random_range(-1.0..1.0);
                let turn = |a, b, c| Rotation3::new(Vector3::new(a, b, c) * 3.0).into_inner();
                let stretch = Matrix3::from_diagonal(&Vector3::new(1.0 + 0.5 * unit(), 1.0, thickness * unit()));
                let matrix = turn(unit(), unit(), unit()) * stretch * turn(unit(), unit(), unit()) * 1e-4;
                let (fast, slow) = (nearest_rotation(&matrix), nearest_rotation_by_decomposition(&matrix));
                // Of a mirror image of almost equal thickness two rotations are almost as near.
                if thickness < 1.0 || matrix.determinant() > 0.0 {
                    assert!((fast - slow).norm() < 1e-9, "{thickness} {fast} {slow}");
                }
            }
        }
        for odd in [Matrix3::zeros(), Matrix3::from_element(f64::NAN), Matrix3::from_element(1.0)] {
            assert!((nearest_rotation(&odd).determinant() - 1.0).abs() < 1e-9);
        }
    }
}
