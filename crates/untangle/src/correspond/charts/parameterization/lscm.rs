//! Least-squares conformal maps (Lévy, Petitjean, Ray and Maillot 2002).

use nalgebra::Point2;

use super::{arap::Arap, flat_faces::FlatFaces};
use crate::correspond::linalg::{Cholesky, SparseSymmetric};

/// Weight of the place that a free vertex has in the unfolding: keeps vertices that only a corner connects with the
/// rest from making the system singular.
const FREE_WEIGHT: f64 = 1e-12;

/// The Cauchy-Riemann equations of all faces in the sense of least squares, two unknowns for each vertex.
#[derive(Debug, Default)]
pub(super) struct ConformalMap {
    matrix: SparseSymmetric,
    factor: Cholesky,
    unknowns: Vec<f64>,
}

impl ConformalMap {
    /// Writes the conformal map that holds two vertices where the unfolding has them: the first, and the one farthest
    /// from it. False where the system can't be solved.
    ///
    /// The elimination order is that of `arap`, whose system has an entry where this one has a block.
    pub(super) fn solve(&mut self, parts: &FlatFaces, arap: &Arap, points: &mut [Point2<f64>]) -> bool {
        self.matrix.start(2 * points.len());
        self.add_faces(parts);
        self.hold_vertices(parts);
        self.matrix.compress();
        if !self.factor.factorise_in_pairs_like(&self.matrix, arap.factor()) {
            return false;
        }
        self.factor.solve(&mut self.unknowns);
        for (point, place) in points.iter_mut().zip(self.unknowns.chunks_exact(2)) {
            *point = Point2::new(place[0], place[1]);
        }
        self.unknowns.iter().all(|value| value.is_finite())
    }

    fn add_faces(&mut self, parts: &FlatFaces) {
        for face in &parts.faces {
            // Row of the real part: w.x u - w.y v; of the imaginary part: w.y u + w.x v; w is the side opposite the
            // corner.
            let opposite = [1, 2, 0].map(|k: usize| face.sides[k] / (2.0 * face.area).sqrt());
            let unknown = |k: usize| 2 * face.corners[k / 2] + k % 2;
            let rows: [[f64; 2]; 6] = std::array::from_fn(|k| {
                let side = opposite[k / 2];
                if k % 2 == 0 { [side.x, side.y] } else { [-side.y, side.x] }
            });
            for (i, [a, c]) in rows.into_iter().enumerate() {
                for (j, [b, d]) in rows.into_iter().enumerate() {
                    self.matrix.add(unknown(i), unknown(j), a * b + c * d);
                }
            }
        }
    }

    fn hold_vertices(&mut self, parts: &FlatFaces) {
        let start = &parts.start;
        let first = parts.faces[0].corners[0];
        let mut second = first;
        for (vertex, _) in parts.is_used.iter().enumerate().filter(|&(_, &used)| used) {
            if (start[vertex] - start[first]).norm_squared() > (start[second] - start[first]).norm_squared() {
                second = vertex;
            }
        }
        self.unknowns.clear();
        for (vertex, place) in start.iter().enumerate() {
            let is_held = vertex == first || vertex == second || !parts.is_used[vertex];
            let weight = if is_held { 1.0 } else { FREE_WEIGHT };
            for (axis, &value) in place.iter().enumerate() {
                self.matrix.add(2 * vertex + axis, 2 * vertex + axis, weight);
                self.unknowns.push(weight * value);
            }
        }
    }
}
