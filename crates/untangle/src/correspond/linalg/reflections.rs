//! Householder reflections that split the affine functions off a matrix, all at once.
//!
//! Their product is `I - V T V^T` with `T` upper triangular (Schreiber and Van Loan 1989), so that the matrix is read
//! twice instead of twice for each.

use nalgebra::Vector2;

use super::rows::{Row, add_scaled, dot};
use crate::simd::{F64_LANES, F64Lanes, InstructionSet, Task, dispatch};

/// The number of affine functions of the plane.
pub(super) const AFFINE: usize = 3;

/// As many reflections as there are affine functions.
#[derive(Debug, Default)]
pub(super) struct Reflections {
    /// The affine functions at the centres, then `V`: the vectors of the reflections, of length root 2, with zeros
    /// before their pivots. What is not needed is zero.
    pub(super) columns: [Vec<Row>; AFFINE],
    /// The upper triangle of the reflected affine functions, column by column.
    pub(super) upper: [[f64; AFFINE]; AFFINE],
    /// `K V`, then what is subtracted beside `V`.
    products: [Vec<Row>; AFFINE],
    count: usize,
}

impl Reflections {
    /// Finds the first `count` reflections, from the affine functions at `size` centres.
    pub(super) fn find(&mut self, count: usize, size: usize) {
        self.count = count;
        for step in 0..count {
            let column = &mut self.columns[step].as_flattened_mut()[..size];
            self.upper[step][..step].copy_from_slice(&column[..step]);
            let length = column[step..].iter().map(|value| value * value).sum::<f64>().sqrt();
            let pivot = if column[step] > 0.0 { -length } else { length };
            self.upper[step][step] = pivot;
            // A vector of length root 2, so that the reflection is I - v v^T.
            column[step] -= pivot;
            let scale = (pivot * column[step]).abs().sqrt().recip();
            column[..step].fill(0.0);
            for value in &mut column[step..] {
                *value *= scale;
            }
            let (done, rest) = self.columns.split_at_mut(step + 1);
            let vector = done[step].as_flattened();
            for other in &mut rest[..count - step - 1] {
                let other = other.as_flattened_mut();
                let along: f64 = vector.iter().zip(&*other).map(|(a, b)| a * b).sum();
                for (to, part) in other.iter_mut().zip(vector) {
                    *to -= along * part;
                }
            }
        }
        for column in &mut self.columns[count..] {
            column.fill([0.0; F64_LANES]);
        }
    }

    /// Reflects values.
    pub(super) fn apply_to_values(&self, values: &mut [Vector2<f64>]) {
        (0..self.count).for_each(|step| self.reflect(step, values));
    }

    /// Reflects values back.
    pub(super) fn undo_on_values(&self, values: &mut [Vector2<f64>]) {
        (0..self.count).rev().for_each(|step| self.reflect(step, values));
    }

    /// `x - v (v . x)`.
    fn reflect(&self, step: usize, values: &mut [Vector2<f64>]) {
        let vector = || self.columns[step].as_flattened().iter().copied();
        let mut along = Vector2::zeros();
        for (part, value) in vector().zip(values.iter()).skip(step) {
            along += value * part;
        }
        for (part, value) in vector().zip(values).skip(step) {
            *value -= along * part;
        }
    }

    /// Reflects the rows and columns of a symmetric matrix, given in full; its lower half holds the result.
    pub(super) fn apply_to_matrix(&mut self, matrix: &mut [Row]) {
        for (product, column) in self.products.iter_mut().zip(&self.columns) {
            product.resize(column.len(), [0.0; F64_LANES]);
        }
        dispatch(Apply { matrix, columns: &self.columns, products: &mut self.products });
    }
}

/// `K - V W^T - W V^T` with `W = Y - V M / 2`, `Y = K V T` and `M = T^T V^T Y`.
struct Apply<'a> {
    matrix: &'a mut [Row],
    columns: &'a [Vec<Row>; AFFINE],
    products: &'a mut [Vec<Row>; AFFINE],
}

impl Task for Apply<'_> {
    #[inline(always)]
    fn run<S: InstructionSet>(self, simd: S) {
        let simd = simd.f64();
        let Self { matrix, columns, products } = self;
        let blocks = columns[0].len().max(1);
        for (slot, of_matrix) in matrix.chunks_exact(blocks).enumerate() {
            for (product, column) in products.iter_mut().zip(columns) {
                product[slot / F64_LANES][slot % F64_LANES] = dot(simd, column, of_matrix);
            }
        }
        let factors = factors(simd, columns);
        // Y, from the last column on, since each takes from those before it.
        for to in (1..AFFINE).rev() {
            let (before, rest) = products.split_at_mut(to);
            for (from, product) in before.iter().enumerate() {
                add_scaled(simd, &mut rest[0], factors[from][to], product);
            }
        }
        let mut middle = [[0.0; AFFINE]; AFFINE];
        for (to, product) in products.iter().enumerate() {
            let along = [0, 1, 2].map(|k: usize| dot(simd, &columns[k], product));
            for from in 0..AFFINE {
                middle[from][to] = (0..=from).map(|k| factors[k][from] * along[k]).sum();
            }
        }
        for (to, product) in products.iter_mut().enumerate() {
            for from in 0..AFFINE {
                add_scaled(simd, product, -0.5 * middle[from][to], &columns[from]);
            }
        }
        for (slot, of_matrix) in matrix.chunks_exact_mut(blocks).enumerate() {
            let first = slot / F64_LANES;
            subtract(simd, &mut of_matrix[first..], columns, products, slot);
        }
    }
}

/// `T`, row by row.
#[inline(always)]
fn factors<L: F64Lanes>(simd: L, columns: &[Vec<Row>; AFFINE]) -> [[f64; AFFINE]; AFFINE] {
    let mut factors = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for to in 1..AFFINE {
        let along = [0, 1, 2].map(|k: usize| if k < to { dot(simd, &columns[k], &columns[to]) } else { 0.0 });
        for (from, row) in factors.iter_mut().enumerate().take(to) {
            row[to] = -(from..to).map(|k| row[k] * along[k]).sum::<f64>();
        }
    }
    factors
}

/// Subtracts `V W^T + W V^T` from the end of one column.
#[inline(always)]
fn subtract<L: F64Lanes>(
    simd: L,
    to: &mut [Row],
    columns: &[Vec<Row>; AFFINE],
    products: &[Vec<Row>; AFFINE],
    slot: usize,
) {
    let first = columns[0].len() - to.len();
    let at = |column: &Vec<Row>| simd.splat(column[slot / F64_LANES][slot % F64_LANES]);
    let [v0, v1, v2] = [at(&columns[0]), at(&columns[1]), at(&columns[2])];
    let [w0, w1, w2] = [at(&products[0]), at(&products[1]), at(&products[2])];
    let vectors = columns[0][first..].iter().zip(&columns[1][first..]).zip(&columns[2][first..]);
    let others = products[0][first..].iter().zip(&products[1][first..]).zip(&products[2][first..]);
    for (to, (((a, b), c), ((p, q), r))) in to.iter_mut().zip(vectors.zip(others)) {
        for lane in (0..F64_LANES).step_by(L::WIDTH) {
            let mut value = simd.load(to, lane);
            for (factor, row) in [(w0, a), (w1, b), (w2, c), (v0, p), (v1, q), (v2, r)] {
                value = simd.sub(value, simd.mul(factor, simd.load(row, lane)));
            }
            simd.store(value, to, lane);
        }
    }
}
