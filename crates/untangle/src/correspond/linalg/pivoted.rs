//! Cholesky factorisation with complete pivoting of a dense symmetric matrix (Higham 2002, section 10.3).
//!
//! By hand: a library chooses its kernels by the processor, and with them the order of its sums. Here the operations
//! and their order are the same for every instruction set, none of them fused.

use super::rows::Row;
use crate::simd::{F64_LANES, F64Lanes, InstructionSet, Task, dispatch};

/// Columns that are subtracted together, so that a column is read and written less often.
const UNROLLED: usize = 4;

/// Factorises a matrix of `order.len()` rows, given column by column in whole rows of lanes, of which the lower half is
/// used: `P A P^T = L L^T`, with `L` in place of the lower half. `order` becomes the row of the matrix that each row of
/// the factor stands for. Returns how many pivots are above zero; the factor has that many columns.
///
/// Cost: n^3 / 3 multiplications for n rows.
pub(super) fn factorise_pivoted(matrix: &mut [Row], order: &mut [usize], diagonal: &mut Vec<Row>) -> usize {
    let blocks = order.len().div_ceil(F64_LANES);
    for (index, slot) in order.iter_mut().enumerate() {
        *slot = index;
    }
    super::rows::clear(diagonal, order.len());
    let entries = matrix.as_flattened().iter().step_by(blocks * F64_LANES + 1);
    for (slot, entry) in diagonal.as_flattened_mut().iter_mut().zip(entries).take(order.len()) {
        *slot = *entry;
    }
    let mut rank = 0;
    dispatch(Factorise { matrix, blocks, order, diagonal, rank: &mut rank });
    rank
}

struct Factorise<'a> {
    matrix: &'a mut [Row],
    /// Rows of lanes of a column.
    blocks: usize,
    order: &'a mut [usize],
    /// What is left of the diagonal.
    diagonal: &'a mut [Row],
    rank: &'a mut usize,
}

impl Task for Factorise<'_> {
    #[inline(always)]
    fn run<S: InstructionSet>(self, simd: S) {
        let Self { matrix, blocks, order, diagonal, rank } = self;
        let stride = blocks * F64_LANES;
        for step in 0..order.len() {
            let left = diagonal.as_flattened_mut();
            let (pivot, largest) = largest(&left[..order.len()], step);
            if largest.is_nan() || largest <= 0.0 {
                return;
            }
            exchange(matrix.as_flattened_mut(), order.len(), stride, [step, pivot]);
            order.swap(step, pivot);
            left.swap(step, pivot);
            let root = largest.sqrt();
            let (done, rest) = matrix.split_at_mut(step * blocks);
            // From the row of lanes with the first entry below the pivot; what lies above it there is of no account.
            let first = (step + 1) / F64_LANES;
            let column = &mut rest[first.min(blocks)..blocks];
            subtract_columns(simd.f64(), column, done, blocks, step);
            divide(simd.f64(), column, root, &mut diagonal[first.min(blocks)..]);
            rest.as_flattened_mut()[step] = root;
            *rank = step + 1;
        }
    }
}

/// The largest entry from `first` on; of several the first one.
#[inline(always)]
fn largest(diagonal: &[f64], first: usize) -> (usize, f64) {
    let mut best = (first, diagonal[first]);
    for (index, &entry) in diagonal.iter().enumerate().skip(first + 1) {
        if entry > best.1 {
            best = (index, entry);
        }
    }
    best
}

/// Exchanges two rows and columns of a matrix whose columns before the first are factorised.
#[inline(always)]
fn exchange(matrix: &mut [f64], size: usize, stride: usize, [first, second]: [usize; 2]) {
    if first == second {
        return;
    }
    for column in 0..first {
        matrix.swap(column * stride + first, column * stride + second);
    }
    matrix.swap(first * stride + first, second * stride + second);
    for between in first + 1..second {
        matrix.swap(first * stride + between, between * stride + second);
    }
    for row in second + 1..size {
        matrix.swap(first * stride + row, second * stride + row);
    }
}

/// Subtracts the columns that are done from the next one, each times its entry in that one's row, from a row of lanes
/// on.
#[inline(always)]
fn subtract_columns<L: F64Lanes>(simd: L, column: &mut [Row], done: &[Row], blocks: usize, step: usize) {
    let above = blocks - column.len();
    let of = |index: usize| {
        let whole = &done[index * blocks..(index + 1) * blocks];
        (simd.splat(whole[step / F64_LANES][step % F64_LANES]), &whole[above..])
    };
    let num_unrolled = step / UNROLLED * UNROLLED;
    for first in (0..num_unrolled).step_by(UNROLLED) {
        let [(a, of_a), (b, of_b), (c, of_c), (d, of_d)] = [of(first), of(first + 1), of(first + 2), of(first + 3)];
        for ((((entry, x), y), z), w) in column.iter_mut().zip(of_a).zip(of_b).zip(of_c).zip(of_d) {
            for lane in (0..F64_LANES).step_by(L::WIDTH) {
                let mut value = simd.load(entry, lane);
                value = simd.sub(value, simd.mul(a, simd.load(x, lane)));
                value = simd.sub(value, simd.mul(b, simd.load(y, lane)));
                value = simd.sub(value, simd.mul(c, simd.load(z, lane)));
                value = simd.sub(value, simd.mul(d, simd.load(w, lane)));
                simd.store(value, entry, lane);
            }
        }
    }
    for index in num_unrolled..step {
        let (factor, values) = of(index);
        for (entry, value) in column.iter_mut().zip(values) {
            for lane in (0..F64_LANES).step_by(L::WIDTH) {
                let value = simd.sub(simd.load(entry, lane), simd.mul(factor, simd.load(value, lane)));
                simd.store(value, entry, lane);
            }
        }
    }
}

/// Divides a column by the root of its pivot, and subtracts it from what is left of the diagonal.
#[inline(always)]
fn divide<L: F64Lanes>(simd: L, column: &mut [Row], root: f64, diagonal: &mut [Row]) {
    let root = simd.splat(root);
    for (entry, left) in column.iter_mut().zip(diagonal) {
        for lane in (0..F64_LANES).step_by(L::WIDTH) {
            let value = simd.div(simd.load(entry, lane), root);
            simd.store(value, entry, lane);
            simd.store(simd.sub(simd.load(left, lane), simd.mul(value, value)), left, lane);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A matrix of the given rank: the sum of as many squares.
    fn matrix(size: usize, rank: usize) -> Vec<f64> {
        let entry = |row: usize, term: usize| ((1 + row * 7 + term * 13 + row * term) as f64 * 0.31).sin();
        let at = |index: usize| (index / size, index % size);
        let product = |(a, b): (usize, usize)| (0..rank).map(|term| entry(a, term) * entry(b, term)).sum();
        (0..size * size).map(|index| product(at(index))).collect()
    }

    #[test]
    fn factorise_pivoted_gives_back_the_matrix_with_falling_pivots() {
        for (size, rank) in [(1, 1), (7, 7), (23, 30), (40, 12)] {
            let whole = matrix(size, rank);
            let (stride, mut order) = (size.next_multiple_of(F64_LANES), vec![0; size]);
            let mut factor = vec![[0.0; F64_LANES]; size * stride / F64_LANES];
            for (to, from) in factor.as_flattened_mut().chunks_exact_mut(stride).zip(whole.chunks_exact(size)) {
                to[..size].copy_from_slice(from);
            }
            let found = factorise_pivoted(&mut factor, &mut order, &mut Vec::new());
            assert!(found >= rank.min(size), "{found} pivots of {rank}");
            let factor = factor.as_flattened();
            let lower = |row: usize, column: usize| if column <= row { factor[column * stride + row] } else { 0.0 };
            for row in 0..size {
                for column in 0..size {
                    let sum: f64 = (0..rank.min(size)).map(|k| lower(row, k) * lower(column, k)).sum();
                    let expected = whole[order[column] * size + order[row]];
                    assert!((sum - expected).abs() < 1e-10, "{size}, {rank}: {sum} {expected}");
                }
            }
            assert!((1..rank.min(size)).all(|k| lower(k, k) <= lower(k - 1, k - 1)));
        }
    }
}
