//! Sparse Cholesky factorisation, in memory that is kept.
//!
//! The order of elimination is that of an approximate minimum degree (Amestoy, Davis and Duff 1996), by faer; the
//! factorisation `P A P^T = L L^T` is up-looking, row by row along the elimination tree (Davis 2006, chapter 4).
//!
//! By hand, though faer 0.24 has the same algorithm in memory of the caller (low-level simplicial factorisation, sparse
//! triangular solutions). Measured on 1,328 systems of charts with 60 to 590 rows, both in kept memory: faer's
//! factorisations take 14 % less time and its solutions 91 % more, so that a parameterisation, with 17 solutions for
//! two factorisations, takes 12 % more. It multiplies by reciprocals of pivots where this one divides: 99.8 % of the
//! coordinates differ in their last bits. Its supernodal factorisation, and its dense kernels, choose instructions by
//! the processor and give other bits on another one; this one has one order of operations for all.

use nalgebra::Vector3;

use faer::sparse::{
    SymbolicSparseColMatRef,
    linalg::amd::{Control, order_maybe_unsorted, order_maybe_unsorted_scratch},
};

use super::{scratch::Scratch, sparse::SparseSymmetric};

const NONE: usize = usize::MAX;

/// A factor, and the memory that it takes to find it.
#[derive(Debug, Default)]
pub(crate) struct Cholesky {
    size: usize,
    /// `P`: the row of the matrix that each step eliminates, and the inverse.
    order: Vec<usize>,
    place: Vec<usize>,
    scratch: Scratch,
    /// Elimination tree: the parent of each step.
    parents: Vec<usize>,
    /// For each step the last one whose row met it.
    marks: Vec<usize>,
    /// Columns that the present row of the factor reaches, ancestors first.
    pattern: Vec<usize>,
    ancestors: Vec<usize>,
    /// The factor column by column, the diagonal first.
    factor_starts: Vec<usize>,
    factor_ends: Vec<usize>,
    factor_rows: Vec<usize>,
    factor_values: Vec<f64>,
    /// The present row of the factor, or the right-hand side in the order of elimination.
    row: Vec<f64>,
}

impl Cholesky {
    /// Factorises a compressed matrix. False where it is not positive definite.
    ///
    /// Cost: for a mesh of n vertices about O(n^1.5).
    pub(crate) fn factorise(&mut self, matrix: &SparseSymmetric) -> bool {
        if !self.find_order(matrix) {
            return false;
        }
        self.grow_tree(matrix);
        self.eliminate(matrix)
    }

    /// Factorises a compressed matrix in the order of elimination of another one with the same pattern. False where it
    /// is not positive definite.
    pub(crate) fn factorise_in_order(&mut self, matrix: &SparseSymmetric, order: &[usize]) -> bool {
        self.size = matrix.size();
        self.order.clear();
        self.order.extend_from_slice(order);
        self.place.resize(self.size, 0);
        for (place, &row) in order.iter().enumerate() {
            self.place[row] = place;
        }
        self.grow_tree(matrix);
        self.eliminate(matrix)
    }

    /// An order of elimination that fills the factor of a compressed matrix little; nothing where there is no memory.
    pub(crate) fn order_of(matrix: &SparseSymmetric) -> Option<Vec<usize>> {
        let mut factor = Self::default();
        factor.find_order(matrix).then_some(factor.order)
    }

    fn find_order(&mut self, matrix: &SparseSymmetric) -> bool {
        self.size = matrix.size();
        let SparseSymmetric { starts, rows, .. } = matrix;
        let pattern = SymbolicSparseColMatRef::new_unsorted_checked(self.size, self.size, starts, None, rows);
        self.order.resize(self.size, 0);
        self.place.resize(self.size, 0);
        let stack = self.scratch.stack(order_maybe_unsorted_scratch::<usize>(self.size, rows.len()));
        order_maybe_unsorted(&mut self.order, &mut self.place, pattern, Control::default(), stack).is_ok()
    }

    /// Factorises a matrix with two rows for each of another one, in that one's order: where rows depend on each other
    /// as there, the order fills the factor no more than one of its own would.
    pub(crate) fn factorise_in_pairs_like(&mut self, matrix: &SparseSymmetric, other: &Self) -> bool {
        self.size = matrix.size();
        debug_assert_eq!(self.size, 2 * other.size);
        self.order.clear();
        self.order.extend(other.order.iter().flat_map(|&row| [2 * row, 2 * row + 1]));
        self.place.resize(self.size, 0);
        for (place, &row) in self.order.iter().enumerate() {
            self.place[row] = place;
        }
        self.grow_tree(matrix);
        self.eliminate(matrix)
    }

    /// Makes the elimination tree, and counts the entries of each column of the factor.
    fn grow_tree(&mut self, matrix: &SparseSymmetric) {
        self.parents.clear();
        self.parents.resize(self.size, NONE);
        self.marks.clear();
        self.marks.resize(self.size, NONE);
        self.factor_starts.clear();
        self.factor_starts.resize(self.size + 1, 0);
        for step in 0..self.size {
            self.marks[step] = step;
            self.factor_starts[step + 1] += 1;
            let column = self.order[step];
            for slot in matrix.starts[column]..matrix.starts[column + 1] {
                // From every entry towards the root, up to where this step has been.
                let mut at = self.place[matrix.rows[slot]];
                while at < step && self.marks[at] != step {
                    if self.parents[at] == NONE {
                        self.parents[at] = step;
                    }
                    self.factor_starts[at + 1] += 1;
                    self.marks[at] = step;
                    at = self.parents[at];
                }
            }
        }
        for step in 0..self.size {
            self.factor_starts[step + 1] += self.factor_starts[step];
        }
    }

    /// Computes the factor row by row: a sparse triangular solution for each.
    fn eliminate(&mut self, matrix: &SparseSymmetric) -> bool {
        let count = self.factor_starts[self.size];
        self.factor_rows.clear();
        self.factor_rows.resize(count, 0);
        self.factor_values.clear();
        self.factor_values.resize(count, 0.0);
        self.factor_ends.clear();
        self.factor_ends.extend_from_slice(&self.factor_starts[..self.size]);
        self.row.clear();
        self.row.resize(self.size, 0.0);
        self.marks.fill(NONE);
        for step in 0..self.size {
            let mut diagonal = self.gather(matrix, step);
            // From the top of the stack: children before their ancestors.
            while let Some(column) = self.pattern.pop() {
                let start = self.factor_starts[column];
                let end = self.factor_ends[column];
                let value = std::mem::take(&mut self.row[column]) / self.factor_values[start];
                for slot in start + 1..end {
                    self.row[self.factor_rows[slot]] -= self.factor_values[slot] * value;
                }
                diagonal -= value * value;
                self.factor_rows[end] = step;
                self.factor_values[end] = value;
                self.factor_ends[column] = end + 1;
            }
            if !(diagonal > 0.0 && diagonal.is_finite()) {
                return false;
            }
            let slot = self.factor_ends[step];
            self.factor_rows[slot] = step;
            self.factor_values[slot] = diagonal.sqrt();
            self.factor_ends[step] = slot + 1;
        }
        true
    }

    /// Puts a row of the matrix into `row` and the columns that it reaches in the elimination tree into `pattern`,
    /// ancestors first. Returns its diagonal.
    fn gather(&mut self, matrix: &SparseSymmetric, step: usize) -> f64 {
        let mut diagonal = 0.0;
        self.marks[step] = step;
        self.pattern.clear();
        let column = self.order[step];
        for slot in matrix.starts[column]..matrix.starts[column + 1] {
            let mut at = self.place[matrix.rows[slot]];
            if at == step {
                diagonal += matrix.values[slot];
            } else if at < step {
                self.row[at] += matrix.values[slot];
                self.ancestors.clear();
                while at < step && self.marks[at] != step {
                    self.ancestors.push(at);
                    self.marks[at] = step;
                    at = self.parents[at];
                }
                // This branch ends below a step that is there already, or at the root; on top of the stack it is taken
                // off first.
                while let Some(at) = self.ancestors.pop() {
                    self.pattern.push(at);
                }
            }
        }
        diagonal
    }

    /// Solves for three right-hand sides at once, in their place: each as [`solve`](Self::solve) does. `rows` is
    /// scratch.
    pub(crate) fn solve_vectors(&self, values: &mut [Vector3<f64>], rows: &mut Vec<Vector3<f64>>) {
        rows.clear();
        rows.extend(self.order.iter().map(|&vertex| values[vertex]));
        let columns = |column: usize| (self.factor_starts[column], self.factor_starts[column + 1]);
        for column in 0..self.size {
            let (start, end) = columns(column);
            let value = rows[column] / self.factor_values[start];
            rows[column] = value;
            for (&row, &factor) in self.factor_rows[start + 1..end].iter().zip(&self.factor_values[start + 1..end]) {
                rows[row] -= value * factor;
            }
        }
        for column in (0..self.size).rev() {
            let (start, end) = columns(column);
            let mut value = rows[column];
            for (&row, &factor) in self.factor_rows[start + 1..end].iter().zip(&self.factor_values[start + 1..end]) {
                value -= rows[row] * factor;
            }
            rows[column] = value / self.factor_values[start];
        }
        for (value, &vertex) in rows.iter().zip(&self.order) {
            values[vertex] = *value;
        }
    }

    /// Solves for one right-hand side, in its place.
    pub(crate) fn solve(&mut self, values: &mut [f64]) {
        for (slot, &vertex) in self.row.iter_mut().zip(&self.order) {
            *slot = values[vertex];
        }
        for column in 0..self.size {
            let (start, end) = (self.factor_starts[column], self.factor_starts[column + 1]);
            self.row[column] /= self.factor_values[start];
            let value = self.row[column];
            for slot in start + 1..end {
                self.row[self.factor_rows[slot]] -= self.factor_values[slot] * value;
            }
        }
        for column in (0..self.size).rev() {
            let (start, end) = (self.factor_starts[column], self.factor_starts[column + 1]);
            let mut value = self.row[column];
            for slot in start + 1..end {
                value -= self.factor_values[slot] * self.row[self.factor_rows[slot]];
            }
            self.row[column] = value / self.factor_values[start];
        }
        for (&value, &vertex) in self.row.iter().zip(&self.order) {
            values[vertex] = value;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The Laplacian of a grid, a little stiffer than singular, with `extra` added to one entry of the diagonal.
    fn laplacian(columns: usize, rows: usize, extra: f64) -> SparseSymmetric {
        let size = columns * rows;
        let mut matrix = SparseSymmetric::default();
        matrix.start(size);
        for at in 0..size {
            matrix.add(at, at, 0.01);
            let mut edge = |a: usize, b: usize| {
                for (row, column, value) in [(a, a, 1.0), (b, b, 1.0), (a, b, -1.0), (b, a, -1.0)] {
                    matrix.add(row, column, value);
                }
            };
            if at % columns + 1 < columns {
                edge(at, at + 1);
            }
            if at + columns < size {
                edge(at, at + columns);
            }
        }
        matrix.add(5, 5, extra);
        matrix.compress();
        matrix
    }

    fn assert_solves(factor: &mut Cholesky, matrix: &SparseSymmetric) {
        let wanted: Vec<f64> = (0..matrix.size()).map(|at| (at as f64 * 0.37).sin()).collect();
        let mut values = matrix.times(&wanted);
        factor.solve(&mut values);
        for (found, wanted) in values.iter().zip(&wanted) {
            assert!((found - wanted).abs() < 1e-10);
        }
    }

    #[test]
    fn cholesky_of_grid_laplacian_solves() {
        let matrix = laplacian(17, 13, 0.0);
        let mut factor = Cholesky::default();
        assert!(factor.factorise(&matrix));
        assert_solves(&mut factor, &matrix);
    }

    #[test]
    fn cholesky_of_three_right_sides_in_a_given_order_is_that_of_each() {
        let matrix = laplacian(17, 13, 0.0);
        let (mut factor, mut other) = (Cholesky::default(), Cholesky::default());
        assert!(factor.factorise(&matrix));
        assert!(other.factorise_in_order(&matrix, &Cholesky::order_of(&matrix).unwrap()));
        let vector = |at: usize| Vector3::new((at as f64).sin(), at as f64, 1.0 / (1.0 + at as f64));
        let mut vectors: Vec<_> = (0..matrix.size()).map(vector).collect();
        other.solve_vectors(&mut vectors, &mut Vec::new());
        for axis in 0..3 {
            let mut values: Vec<f64> = (0..matrix.size()).map(|at| vector(at)[axis]).collect();
            factor.solve(&mut values);
            assert!(values.iter().zip(&vectors).all(|(value, all)| value.to_bits() == all[axis].to_bits()));
        }
    }

    #[test]
    fn cholesky_in_pairs_of_blocks_solves() {
        let matrix = laplacian(17, 13, 0.0);
        let (mut factor, mut factor_of_blocks) = (Cholesky::default(), Cholesky::default());
        assert!(factor.factorise(&matrix));
        let mut blocks = matrix.with_blocks();
        blocks.compress();
        assert!(factor_of_blocks.factorise_in_pairs_like(&blocks, &factor));
        assert_solves(&mut factor_of_blocks, &blocks);
    }

    #[test]
    fn cholesky_of_indefinite_matrix_fails_and_its_memory_serves_again() {
        let mut factor = Cholesky::default();
        assert!(!factor.factorise(&laplacian(17, 13, -9.0)));
        let matrix = laplacian(11, 7, 0.0);
        assert!(factor.factorise(&matrix));
        assert_solves(&mut factor, &matrix);
    }
}
