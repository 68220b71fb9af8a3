//! Sparse Cholesky factorisation, in memory that is kept.
//!
//! The order of elimination is that of an approximate minimum degree ([`MinimumDegree`]); the factorisation
//! `P A P^T = L L^T` is up-looking, row by row along the elimination tree (Davis 2006, chapter 4).
//!
//! By hand: the sparse and the dense kernels of a library choose instructions by the processor, and give other bits on
//! another one; this one has one order of operations for all.

mod solve;
#[cfg(test)]
mod tests;

use super::{ordering::MinimumDegree, sparse::SparseSymmetric};

const NONE: usize = usize::MAX;

/// A factor, and the memory that it takes to find it.
#[derive(Debug, Default)]
pub(crate) struct Cholesky {
    size: usize,
    /// `P`: the row of the matrix that each step eliminates, and the inverse.
    order: Vec<usize>,
    place: Vec<usize>,
    ordering: MinimumDegree,
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
    factor_rows: Vec<u32>,
    factor_values: Vec<f64>,
    /// The present row of the factor, or the right-hand side in the order of elimination.
    row: Vec<f64>,
}

impl Cholesky {
    /// Factorises a compressed matrix. False where it is not positive definite.
    ///
    /// Cost: for a mesh of n vertices about O(n^1.5).
    pub(crate) fn factorise(&mut self, matrix: &SparseSymmetric) -> bool {
        self.ordering.find(&matrix.starts, &matrix.rows, &mut self.order);
        self.find_places();
        self.grow_tree(matrix);
        self.eliminate(matrix)
    }

    /// Factorises a compressed matrix in the order of elimination of another one with the same pattern. False where it
    /// is not positive definite.
    pub(crate) fn factorise_in_order(&mut self, matrix: &SparseSymmetric, order: &[usize]) -> bool {
        self.set_order(order.iter().copied());
        self.grow_tree(matrix);
        self.eliminate(matrix)
    }

    /// Factorises a matrix with two rows for each of another one, in that one's order: where rows depend on each other
    /// as there, the order fills the factor no more than one of its own would.
    pub(crate) fn factorise_in_pairs_like(&mut self, matrix: &SparseSymmetric, other: &Self) -> bool {
        self.set_order(other.order.iter().flat_map(|&row| [2 * row, 2 * row + 1]));
        debug_assert_eq!(self.size, matrix.size());
        self.grow_tree(matrix);
        self.eliminate(matrix)
    }

    /// An order of elimination that fills the factor of a compressed matrix little.
    pub(crate) fn order_of(matrix: &SparseSymmetric) -> Vec<usize> {
        let mut order = Vec::new();
        MinimumDegree::default().find(&matrix.starts, &matrix.rows, &mut order);
        order
    }

    /// Takes an order of elimination.
    pub(super) fn set_order(&mut self, order: impl Iterator<Item = usize>) {
        self.order.clear();
        self.order.extend(order);
        self.find_places();
    }

    fn find_places(&mut self) {
        self.size = self.order.len();
        self.place.resize(self.size, 0);
        for (place, &row) in self.order.iter().enumerate() {
            self.place[row] = place;
        }
    }

    /// Makes the elimination tree, and counts the entries of each column of the factor.
    pub(super) fn grow_tree(&mut self, matrix: &SparseSymmetric) {
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
                let slots = start + 1..end;
                for (&row, &factor) in self.factor_rows[slots.clone()].iter().zip(&self.factor_values[slots]) {
                    self.row[row as usize] -= factor * value;
                }
                diagonal -= value * value;
                self.factor_rows[end] = row_number(step);
                self.factor_values[end] = value;
                self.factor_ends[column] = end + 1;
            }
            if !(diagonal > 0.0 && diagonal.is_finite()) {
                return false;
            }
            let slot = self.factor_ends[step];
            self.factor_rows[slot] = row_number(step);
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
}

/// Rows are those of vertices, whose numbers have 32 bits, or two for each.
#[expect(clippy::cast_possible_truncation, reason = "the entries of larger factors don't fit into memory")]
fn row_number(step: usize) -> u32 {
    step as u32
}

#[cfg(test)]
impl Cholesky {
    /// The number of entries of the factor, as the tree has it.
    pub(super) fn num_entries(&self) -> usize {
        self.factor_starts[self.size]
    }
}
