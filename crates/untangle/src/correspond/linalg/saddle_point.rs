//! The saddle-point system of a thin-plate fit: kernels for the centres, bordered by the affine functions.
//!
//! On weights without an affine part the kernels are positive definite (Duchon 1977). So Householder reflections split
//! the affine part off, and a Cholesky factorisation with complete pivoting solves the rest: a quarter of the work of
//! an orthogonal factorisation of the whole system, and its pivots tell rank and condition.

use nalgebra::{Point2, Vector2};

use super::{
    pivoted::factorise_pivoted,
    reflections::{AFFINE, Reflections},
    rows::{self, Row},
    triangular::solve_leading,
};
use crate::simd::F64_LANES;

/// Pivots below this part of the largest count as zero.
const RANK_TOLERANCE: f64 = 1e-11;

/// Solves the system `K w + P a = v`, `P^T w = 0` in memory of its own, where row i of `P` is `(1, x_i, y_i)`.
///
/// Matrices are kept column by column, each padded with zeros to whole rows of lanes.
#[derive(Debug, Default)]
pub(crate) struct SaddlePoint {
    /// `K`, then the lower half of the reflected matrix.
    kernels: Vec<Row>,
    /// The block of it that belongs to weights without an affine part, then its factor.
    inner: Vec<Row>,
    /// What splits the affine functions off.
    reflections: Reflections,
    /// For each of an orthogonal basis of the affine functions its coefficients of 1, x and y.
    coefficients: [[f64; AFFINE]; AFFINE],
    /// The reflected values.
    right_sides: Vec<Vector2<f64>>,
    weights: Vec<Vector2<f64>>,
    /// The pivoting.
    order: Vec<usize>,
    /// Scratch of the factorisation, and both coordinates of what is to be solved for, in the order of its pivots.
    diagonal: Vec<Row>,
    unknowns: [Vec<Row>; 2],
    rank: usize,
    condition: f64,
}

/// The solution of the system.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Solution<'a> {
    /// `w`, one for each centre.
    pub(crate) weights: &'a [Vector2<f64>],
    /// `a`.
    pub(crate) polynomial: [Vector2<f64>; 3],
}

impl SaddlePoint {
    /// Solves for centres with mean 0. `kernels` writes the matrix of the kernels of all centres at each of them, each
    /// column padded to whole rows of lanes. Weights and affine functions without a pivot are zero. Nothing where
    /// numbers overflow.
    ///
    /// Cost: n^3 / 3 multiplications for n centres.
    pub(crate) fn solve(
        &mut self,
        centres: &[Point2<f64>],
        values: &[Vector2<f64>],
        kernels: impl FnOnce(&mut Vec<Row>),
    ) -> Option<Solution<'_>> {
        let size = centres.len();
        kernels(&mut self.kernels);
        self.right_sides.clear();
        self.right_sides.extend_from_slice(values);
        let num_affine = self.span(centres);
        self.reflections.find(num_affine, size);
        self.reflections.apply_to_values(&mut self.right_sides);
        self.reflections.apply_to_matrix(&mut self.kernels);
        let inner_rank = self.factorise(num_affine)?;
        self.rank = inner_rank + 2 * num_affine;

        self.substitute(num_affine, inner_rank);
        let stride = size.next_multiple_of(F64_LANES);
        let upper = &self.reflections.upper;
        let mut affine = [Vector2::zeros(); AFFINE];
        for k in (0..num_affine).rev() {
            let mut rest = self.right_sides[k];
            let column = &self.kernels.as_flattened()[k * stride..k * stride + size];
            for (weight, kernel) in self.weights.iter().zip(column).skip(num_affine) {
                rest -= weight * *kernel;
            }
            for column in k + 1..num_affine {
                rest -= affine[column] * upper[column][k];
            }
            affine[k] = rest / upper[k][k];
        }
        self.reflections.undo_on_values(&mut self.weights);
        let mut polynomial = [Vector2::zeros(); AFFINE];
        for (value, coefficients) in affine.iter().zip(&self.coefficients).take(num_affine) {
            for (sum, coefficient) in polynomial.iter_mut().zip(coefficients) {
                *sum += value * *coefficient;
            }
        }
        Some(Solution { weights: &self.weights, polynomial })
    }

    /// Rank of the system; full is the number of centres plus three.
    pub(crate) fn rank(&self) -> usize {
        self.rank
    }

    /// The ratio of the largest to the smallest pivot of the kernels on weights without an affine part; 1 where there
    /// is none.
    pub(crate) fn condition(&self) -> f64 {
        self.condition
    }

    /// Writes an orthogonal basis of the affine functions: constant, along the main direction of the centres, across
    /// it. Returns how many there are: without the last where they lie on a line.
    fn span(&mut self, centres: &[Point2<f64>]) -> usize {
        let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
        for centre in centres {
            xx += centre.x * centre.x;
            xy += centre.x * centre.y;
            yy += centre.y * centre.y;
        }
        let [cos, sin] = main_direction(xx - yy, 2.0 * xy);
        self.coefficients = [[1.0, 0.0, 0.0], [0.0, cos, sin], [0.0, -sin, cos]];
        let mut lengths = [0.0; AFFINE];
        let columns = self.reflections.columns.iter_mut().zip(self.coefficients);
        for ((column, [one, x, y]), length) in columns.zip(&mut lengths) {
            rows::clear(column, centres.len());
            for (slot, centre) in column.as_flattened_mut().iter_mut().zip(centres) {
                *slot = one + x * centre.x + y * centre.y;
            }
            *length = column.as_flattened().iter().map(|value| value * value).sum::<f64>().sqrt();
        }
        1 + lengths[1..].iter().take_while(|&&length| length > RANK_TOLERANCE * lengths[0]).count()
    }

    /// Factorises the kernels without the first `skip` rows and columns, and returns their rank. Nothing where numbers
    /// overflow.
    fn factorise(&mut self, skip: usize) -> Option<usize> {
        let size = self.right_sides.len();
        let (stride, count) = (size.next_multiple_of(F64_LANES), size - skip);
        let inner_stride = count.next_multiple_of(F64_LANES);
        rows::clear(&mut self.inner, count * inner_stride);
        let columns = self.kernels.as_flattened().chunks_exact(stride).skip(skip);
        for ((to, from), column) in
            self.inner.as_flattened_mut().chunks_exact_mut(inner_stride.max(1)).zip(columns).zip(0..)
        {
            to[column..count].copy_from_slice(&from[skip + column..size]);
        }
        let inner = self.inner.as_flattened();
        if inner.iter().any(|value| !value.is_finite()) {
            return None;
        }
        self.condition = 1.0;
        if (0..count).all(|k| inner[k * inner_stride + k] <= 0.0) {
            // All centres in one place, or as many as there are affine functions: the block is zero or empty.
            return Some(0);
        }
        self.order.resize(count, 0);
        let rank = factorise_pivoted(&mut self.inner, &mut self.order, &mut self.diagonal);
        let inner = self.inner.as_flattened();
        let pivot = |k: usize| inner[k * inner_stride + k].powi(2);
        let rank = (0..rank).take_while(|&k| pivot(k) > pivot(0) * RANK_TOLERANCE).count();
        if rank > 0 {
            self.condition = pivot(0) / pivot(rank - 1);
        }
        Some(rank)
    }

    /// Solves for the reflected weights in the leading `rank` rows and columns of the factor.
    fn substitute(&mut self, skip: usize, rank: usize) {
        self.weights.clear();
        self.weights.resize(self.right_sides.len(), Vector2::zeros());
        if rank == 0 {
            return;
        }
        let order = &self.order[..rank];
        for (axis, unknowns) in self.unknowns.iter_mut().enumerate() {
            rows::clear(unknowns, self.order.len());
            for (slot, &row) in unknowns.as_flattened_mut().iter_mut().zip(order) {
                *slot = self.right_sides[skip + row][axis];
            }
        }
        solve_leading(&self.inner, rank, &mut self.unknowns);
        let [x, y] = &self.unknowns;
        for ((&row, &x), &y) in order.iter().zip(x.as_flattened()).zip(y.as_flattened()) {
            self.weights[skip + row] = Vector2::new(x, y);
        }
    }
}

/// Cosine and sine of half the angle of the direction (x, y), between -90 and 90 degrees: from square roots, since the
/// bits of the standard library's sines depend on the processor.
fn main_direction(x: f64, y: f64) -> [f64; 2] {
    let length = (x * x + y * y).sqrt();
    if length.is_nan() || length <= 0.0 {
        return [1.0, 0.0];
    }
    // The half angle's cosine and sine from the sum that does not cancel.
    if x >= 0.0 {
        let cos = (0.5 * (1.0 + x / length)).sqrt();
        [cos, 0.5 * (y / length) / cos]
    } else {
        let sin = (0.5 * (1.0 - x / length)).sqrt().copysign(y);
        [0.5 * (y / length) / sin, sin]
    }
}
