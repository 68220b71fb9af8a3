//! As-rigid-as-possible parameterisation: the local-global iteration of Liu, Zhang, Xu, Gotsman and Gortler (2008),
//! after Sorkine and Alexa (2007).

use nalgebra::{Point2, Vector2};

use super::flat_faces::FlatFaces;
use crate::{
    correspond::linalg::{Cholesky, SparseSymmetric},
    geometry::{complex_product, conjugate_product},
};

const ITERATIONS: usize = 8;
/// Weight of the place that a free vertex had in the last iteration, which keeps the system definite.
const FREE_WEIGHT: f64 = 1e-9;

/// The cotangent Laplacian of the faces, factorised, with one right-hand side for each axis.
#[derive(Debug, Default)]
pub(super) struct Arap {
    matrix: SparseSymmetric,
    factor: Cholesky,
    unknowns: [Vec<f64>; 2],
}

impl Arap {
    /// Factorises the global system, which does not depend on places. False where it is not positive definite.
    pub(super) fn factorise(&mut self, parts: &FlatFaces) -> bool {
        self.matrix.start(parts.start.len());
        for face in &parts.faces {
            for (k, &weight) in face.weights.iter().enumerate() {
                let (a, b) = (face.corners[k], face.corners[(k + 1) % 3]);
                for (row, column, value) in [(a, a, weight), (b, b, weight), (a, b, -weight), (b, a, -weight)] {
                    self.matrix.add(row, column, value);
                }
            }
        }
        for vertex in 0..parts.start.len() {
            self.matrix.add(vertex, vertex, hold(parts, vertex));
        }
        self.matrix.compress();
        self.factor.factorise(&self.matrix)
    }

    /// The factor of the global system.
    pub(super) fn factor(&self) -> &Cholesky {
        &self.factor
    }

    /// Alternates the best rotation of every face (local step) and the best places for these rotations (global step).
    /// False where a place is not finite.
    pub(super) fn iterate(&mut self, parts: &FlatFaces, points: &mut [Point2<f64>]) -> bool {
        for _ in 0..ITERATIONS {
            self.rotate_faces(parts, points);
            self.unknowns.iter_mut().for_each(|places| self.factor.solve(places));
            let [x, y] = &self.unknowns;
            for (point, (&x, &y)) in points.iter_mut().zip(x.iter().zip(y)) {
                *point = Point2::new(x, y);
            }
        }
        points.iter().all(|point| point.x.is_finite() && point.y.is_finite())
    }

    /// Writes the right-hand sides: the sides of all shapes, each face rotated as fits its present places best.
    fn rotate_faces(&mut self, parts: &FlatFaces, points: &[Point2<f64>]) {
        for (axis, places) in self.unknowns.iter_mut().enumerate() {
            places.clear();
            places.extend(points.iter().enumerate().map(|(vertex, point)| hold(parts, vertex) * point[axis]));
        }
        for face in &parts.faces {
            let mut rotation = Vector2::zeros();
            for (k, &weight) in face.weights.iter().enumerate() {
                let present = points[face.corners[(k + 1) % 3]] - points[face.corners[k]];
                rotation += conjugate_product(face.sides[k], present) * weight;
            }
            let rotation = rotation.try_normalize(0.0).unwrap_or_else(Vector2::x);
            for (k, &weight) in face.weights.iter().enumerate() {
                let rotated = complex_product(rotation, face.sides[k]) * weight;
                for (axis, places) in self.unknowns.iter_mut().enumerate() {
                    places[face.corners[k]] -= rotated[axis];
                    places[face.corners[(k + 1) % 3]] += rotated[axis];
                }
            }
        }
    }
}

/// How firmly a vertex is held where it lies: the first one, and those without a face, keep their places.
fn hold(parts: &FlatFaces, vertex: usize) -> f64 {
    if vertex == parts.faces[0].corners[0] || !parts.is_used[vertex] { 1.0 } else { FREE_WEIGHT }
}
