//! Cholesky factorisation with complete pivoting of a dense symmetric matrix (Higham 2002, section 10.3).
//!
//! By hand: a library chooses its kernels by the processor, and with them the order of its sums. Here the operations
//! and their order are the same for every instruction set, none of them fused.

use crate::simd::{InstructionSet, Task, dispatch};

/// Columns that are subtracted together, so that a column is read and written less often.
const UNROLLED: usize = 4;

/// Factorises a matrix of `order.len()` rows, given column by column, of which the lower half is used: `P A P^T = L
/// L^T`, with `L` in place of the lower half. `order` becomes the row of the matrix that each row of the factor stands
/// for. Returns how many pivots are above zero; the factor has that many columns.
///
/// Cost: n^3 / 3 multiplications for n rows.
pub(super) fn factorise_pivoted(matrix: &mut [f64], order: &mut [usize], diagonal: &mut Vec<f64>) -> usize {
    let size = order.len();
    for (index, slot) in order.iter_mut().enumerate() {
        *slot = index;
    }
    diagonal.clear();
    diagonal.extend((0..size).map(|k| matrix[k * size + k]));
    for step in 0..size {
        let pivot = (step + 1..size).fold(step, |best, k| if diagonal[k] > diagonal[best] { k } else { best });
        if diagonal[pivot].is_nan() || diagonal[pivot] <= 0.0 {
            return step;
        }
        exchange(matrix, size, step, pivot);
        order.swap(step, pivot);
        diagonal.swap(step, pivot);
        let root = diagonal[step].sqrt();
        matrix[step * size + step] = root;
        let (done, rest) = matrix.split_at_mut(step * size);
        let column = &mut rest[step + 1..size];
        dispatch(Column { done, size, step, column, root, diagonal: &mut diagonal[step + 1..] });
    }
    size
}

/// Exchanges two rows and columns of a matrix whose columns before the first are factorised.
fn exchange(matrix: &mut [f64], size: usize, first: usize, second: usize) {
    if first == second {
        return;
    }
    for column in 0..first {
        matrix.swap(column * size + first, column * size + second);
    }
    matrix.swap(first * size + first, second * size + second);
    for between in first + 1..second {
        matrix.swap(first * size + between, between * size + second);
    }
    for row in second + 1..size {
        matrix.swap(first * size + row, second * size + row);
    }
}

/// The next column of the factor, below its pivot.
struct Column<'a> {
    /// The columns before it.
    done: &'a [f64],
    size: usize,
    step: usize,
    /// Entries of the matrix, which become those of the factor.
    column: &'a mut [f64],
    root: f64,
    /// What is left of the diagonal in the same rows.
    diagonal: &'a mut [f64],
}

impl Task for Column<'_> {
    #[inline(always)]
    fn run<S: InstructionSet>(self, _: S) {
        let Self { done, size, step, column, root, diagonal } = self;
        let of = |index: usize| {
            let whole = &done[index * size..(index + 1) * size];
            (whole[step], &whole[step + 1..])
        };
        let num_unrolled = step / UNROLLED * UNROLLED;
        for first in (0..num_unrolled).step_by(UNROLLED) {
            let [(a, of_a), (b, of_b), (c, of_c), (d, of_d)] = [of(first), of(first + 1), of(first + 2), of(first + 3)];
            for ((((entry, x), y), z), w) in column.iter_mut().zip(of_a).zip(of_b).zip(of_c).zip(of_d) {
                *entry = *entry - a * x - b * y - c * z - d * w;
            }
        }
        for index in num_unrolled..step {
            let (factor, values) = of(index);
            for (entry, value) in column.iter_mut().zip(values) {
                *entry -= factor * value;
            }
        }
        for (entry, left) in column.iter_mut().zip(diagonal) {
            *entry /= root;
            *left -= *entry * *entry;
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
            let (mut factor, mut order) = (whole.clone(), vec![0; size]);
            let found = factorise_pivoted(&mut factor, &mut order, &mut Vec::new());
            assert!(found >= rank.min(size), "{found} pivots of {rank}");
            let lower = |row: usize, column: usize| if column <= row { factor[column * size + row] } else { 0.0 };
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
