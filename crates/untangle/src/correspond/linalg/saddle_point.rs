//! The saddle-point system of a thin-plate fit: kernels for the centres, bordered by the affine functions.
//!
//! On weights without an affine part the kernels are positive definite (Duchon 1977). So Householder reflections split
//! the affine part off, and a Cholesky factorisation with complete pivoting solves the rest: a quarter of the work of
//! an orthogonal factorisation of the whole system, and its pivots tell rank and condition.

use nalgebra::{Point2, Vector2};

use super::pivoted::factorise_pivoted;

/// Pivots below this part of the largest count as zero.
const RANK_TOLERANCE: f64 = 1e-11;

/// Solves the system `K w + P a = v`, `P^T w = 0` in memory of its own, where row i of `P` is `(1, x_i, y_i)`.
#[derive(Debug, Default)]
pub(crate) struct SaddlePoint {
    /// `K` column by column, then the reflected matrix.
    kernels: Vec<f64>,
    /// The block of it that belongs to weights without an affine part, column by column, then its factor.
    inner: Vec<f64>,
    /// An orthogonal basis of the affine functions at the centres, then the vectors of the reflections, with zeros
    /// before their pivots.
    affine: [Vec<f64>; 3],
    /// For each of them its coefficients of 1, x and y.
    coefficients: [[f64; 3]; 3],
    product: Vec<f64>,
    /// The reflected values.
    right_sides: Vec<Vector2<f64>>,
    weights: Vec<Vector2<f64>>,
    /// The pivoting.
    order: Vec<usize>,
    /// Scratch of the factorisation.
    diagonal: Vec<f64>,
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
    /// Solves for centres with mean 0. `row` writes the kernels of all centres at one of them. Weights and affine
    /// functions without a pivot are zero. Nothing where numbers overflow.
    ///
    /// Cost: n^3 / 3 multiplications for n centres.
    pub(crate) fn solve(
        &mut self,
        centres: &[Point2<f64>],
        values: &[Vector2<f64>],
        row: impl Fn(Point2<f64>, &mut [f64]),
    ) -> Option<Solution<'_>> {
        let size = centres.len();
        self.kernels.resize(size * size, 0.0);
        for (&centre, column) in centres.iter().zip(self.kernels.chunks_exact_mut(size)) {
            row(centre, column);
        }
        self.right_sides.clear();
        self.right_sides.extend_from_slice(values);
        let num_affine = self.span(centres);
        // Upper triangle of the reflected affine functions.
        let mut upper = [[0.0; 3]; 3];
        for step in 0..num_affine {
            self.reflect(step, num_affine, &mut upper);
        }
        let inner_rank = self.factorise(num_affine)?;
        self.rank = inner_rank + 2 * num_affine;

        self.weights.clear();
        self.weights.resize(size, Vector2::zeros());
        self.substitute(num_affine, inner_rank);
        let mut affine = [Vector2::zeros(); 3];
        for k in (0..num_affine).rev() {
            let mut rest = self.right_sides[k];
            for (slot, weight) in self.weights.iter().enumerate().skip(num_affine) {
                rest -= weight * self.kernels[k * size + slot];
            }
            for column in k + 1..num_affine {
                rest -= affine[column] * upper[column][k];
            }
            affine[k] = rest / upper[k][k];
        }
        for step in (0..num_affine).rev() {
            reflect_values(&self.affine[step], step, &mut self.weights);
        }
        let mut polynomial = [Vector2::zeros(); 3];
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
    /// it; without the last where they lie on a line. Returns how many there are.
    fn span(&mut self, centres: &[Point2<f64>]) -> usize {
        let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
        for centre in centres {
            xx += centre.x * centre.x;
            xy += centre.x * centre.y;
            yy += centre.y * centre.y;
        }
        let [cos, sin] = main_direction(xx - yy, 2.0 * xy);
        self.coefficients = [[1.0, 0.0, 0.0], [0.0, cos, sin], [0.0, -sin, cos]];
        let mut lengths = [0.0; 3];
        for ((column, [one, x, y]), length) in self.affine.iter_mut().zip(self.coefficients).zip(&mut lengths) {
            column.clear();
            column.extend(centres.iter().map(|centre| one + x * centre.x + y * centre.y));
            *length = column.iter().map(|value| value * value).sum::<f64>().sqrt();
        }
        1 + lengths[1..].iter().take_while(|&&length| length > RANK_TOLERANCE * lengths[0]).count()
    }

    /// Reflects kernels, affine functions and values so that column `step` of the affine functions has zeros below its
    /// pivot.
    fn reflect(&mut self, step: usize, num_affine: usize, upper: &mut [[f64; 3]; 3]) {
        let size = self.right_sides.len();
        let column = &mut self.affine[step];
        upper[step][..step].copy_from_slice(&column[..step]);
        let length = column[step..].iter().map(|value| value * value).sum::<f64>().sqrt();
        let pivot = if column[step] > 0.0 { -length } else { length };
        upper[step][step] = pivot;
        // A vector of length root 2, so that the reflection is I - v v^T.
        column[step] -= pivot;
        let scale = (pivot * column[step]).abs().sqrt().recip();
        column[..step].fill(0.0);
        for value in &mut column[step..] {
            *value *= scale;
        }
        let (done, rest) = self.affine.split_at_mut(step + 1);
        let vector = &done[step];
        for other in &mut rest[..num_affine - step - 1] {
            let along = dot(vector, other);
            add_scaled(other, -along, vector);
        }
        reflect_values(vector, step, &mut self.right_sides);
        // K - v p^T - p v^T with p = K v - v (v . K v) / 2.
        self.product.clear();
        self.product.extend(self.kernels.chunks_exact(size).map(|kernels| dot(vector, kernels)));
        let half = 0.5 * dot(vector, &self.product);
        add_scaled(&mut self.product, -half, vector);
        for (slot, kernels) in self.kernels.chunks_exact_mut(size).enumerate() {
            add_scaled(kernels, -self.product[slot], vector);
            add_scaled(kernels, -vector[slot], &self.product);
        }
    }

    /// Factorises the kernels without the first `skip` rows and columns, and returns their rank. Nothing where numbers
    /// overflow.
    fn factorise(&mut self, skip: usize) -> Option<usize> {
        let size = self.right_sides.len();
        let inner = size - skip;
        self.inner.clear();
        for column in self.kernels.chunks_exact(size).skip(skip) {
            self.inner.extend_from_slice(&column[skip..]);
        }
        if self.inner.iter().any(|value| !value.is_finite()) {
            return None;
        }
        self.condition = 1.0;
        if (0..inner).all(|k| self.inner[k * inner + k] <= 0.0) {
            // All centres in one place, or as many as there are affine functions: the block is zero or empty.
            return Some(0);
        }
        self.order.resize(inner, 0);
        let rank = factorise_pivoted(&mut self.inner, &mut self.order, &mut self.diagonal);
        let pivot = |k: usize| self.inner[k * inner + k].powi(2);
        let rank = (0..rank).take_while(|&k| pivot(k) > pivot(0) * RANK_TOLERANCE).count();
        if rank > 0 {
            self.condition = pivot(0) / pivot(rank - 1);
        }
        Some(rank)
    }

    /// Solves for the reflected weights by forward and back substitution in the leading `rank` rows and columns of the
    /// factor.
    fn substitute(&mut self, skip: usize, rank: usize) {
        let inner = self.right_sides.len() - skip;
        let lower = |row: usize, column: usize| self.inner[column * inner + row];
        let order = &self.order;
        for row in 0..rank {
            let mut rest = self.right_sides[skip + order[row]];
            for (column, &slot) in order[..row].iter().enumerate() {
                rest -= self.weights[skip + slot] * lower(row, column);
            }
            self.weights[skip + order[row]] = rest / lower(row, row);
        }
        for row in (0..rank).rev() {
            let mut rest = self.weights[skip + order[row]];
            for (below, &slot) in order.iter().enumerate().take(rank).skip(row + 1) {
                rest -= self.weights[skip + slot] * lower(below, row);
            }
            self.weights[skip + order[row]] = rest / lower(row, row);
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

/// Reflects values: `x - v (v . x)`, where `v` has zeros before `from`.
fn reflect_values(vector: &[f64], from: usize, values: &mut [Vector2<f64>]) {
    let mut along = Vector2::zeros();
    for (part, value) in vector.iter().zip(values.iter()).skip(from) {
        along += value * *part;
    }
    for (part, value) in vector.iter().zip(values).skip(from) {
        *value -= along * *part;
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    // Four partial sums, so that the loop vectorises.
    let mut sums = [0.0; 4];
    let (a, b) = (a.chunks_exact(4), b.chunks_exact(4));
    let rest: f64 = a.remainder().iter().zip(b.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in a.zip(b) {
        for lane in 0..4 {
            sums[lane] += a[lane] * b[lane];
        }
    }
    sums.iter().sum::<f64>() + rest
}

/// `to + factor * values`.
fn add_scaled(to: &mut [f64], factor: f64, values: &[f64]) {
    for (to, value) in to.iter_mut().zip(values) {
        *to += factor * value;
    }
}
