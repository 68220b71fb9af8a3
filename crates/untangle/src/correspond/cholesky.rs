//! Sparse symmetric positive definite systems, solved in memory that is kept.
//!
//! The factorisation of faer makes its symbolic part anew in fresh memory each time; here a frame must take none. So: the ordering of
//! faer (approximate minimum degree, Amestoy, Davis and Duff 1996), and the up-looking factorisation `P A P^T = L L^T` row by row along the
//! elimination tree (Davis 2006, chapter 4).

use faer::sparse::{
    SymbolicSparseColMatRef,
    linalg::amd::{Control, order_maybe_unsorted, order_maybe_unsorted_scratch},
};

use super::memory::Memory;

const NONE: usize = usize::MAX;

/// A matrix, its factor, and the memory for both.
#[derive(Debug, Default)]
pub(crate) struct Cholesky {
    size: usize,
    entries: Vec<(usize, usize, f64)>,
    /// The matrix column by column, each entry once, rows in no order.
    starts: Vec<usize>,
    rows: Vec<usize>,
    values: Vec<f64>,
    order: Vec<usize>,
    place: Vec<usize>,
    memory: Memory,
    /// Elimination tree, and for each row the last step that met it.
    parents: Vec<usize>,
    marks: Vec<usize>,
    pattern: Vec<usize>,
    path: Vec<usize>,
    /// The factor column by column, the diagonal first.
    factor_starts: Vec<usize>,
    factor_ends: Vec<usize>,
    factor_rows: Vec<usize>,
    factor_values: Vec<f64>,
    row: Vec<f64>,
}

impl Cholesky {
    /// Begins a matrix of zeros, `size x size`.
    pub(crate) fn start(&mut self, size: usize) {
        self.size = size;
        self.entries.clear();
    }

    /// Adds to an entry. Both halves of the matrix are to be given.
    pub(crate) fn add(&mut self, row: usize, column: usize, value: f64) {
        self.entries.push((row, column, value));
    }

    /// Factorises. False where the matrix is not positive definite.
    ///
    /// Cost: for a mesh of n vertices about O(n^1.5).
    pub(crate) fn factorise(&mut self) -> bool {
        self.compress();
        let pattern =
            SymbolicSparseColMatRef::new_unsorted_checked(self.size, self.size, &self.starts, None, &self.rows);
        self.order.resize(self.size, 0);
        self.place.resize(self.size, 0);
        let stack = self.memory.stack(order_maybe_unsorted_scratch::<usize>(self.size, self.rows.len()));
        if order_maybe_unsorted(&mut self.order, &mut self.place, pattern, Control::default(), stack).is_err() {
            return false;
        }
        self.grow_tree();
        self.eliminate()
    }

    /// Factorises a matrix with two rows for each of another one, in that one's order: where rows depend on each other as there, it is as good
    /// as one of its own.
    pub(crate) fn factorise_in_pairs_like(&mut self, other: &Self) -> bool {
        debug_assert_eq!(self.size, 2 * other.size);
        self.compress();
        self.order.clear();
        self.order.extend(other.order.iter().flat_map(|&row| [2 * row, 2 * row + 1]));
        self.place.resize(self.size, 0);
        for (place, &row) in self.order.iter().enumerate() {
            self.place[row] = place;
        }
        self.grow_tree();
        self.eliminate()
    }

    /// Sorts the entries into columns and adds up those of one place.
    fn compress(&mut self) {
        self.starts.clear();
        self.starts.resize(self.size + 1, 0);
        for &(_, column, _) in &self.entries {
            self.starts[column + 1] += 1;
        }
        for column in 0..self.size {
            self.starts[column + 1] += self.starts[column];
        }
        self.rows.clear();
        self.rows.resize(self.entries.len(), 0);
        self.values.clear();
        self.values.resize(self.entries.len(), 0.0);
        self.marks.clear();
        self.marks.extend_from_slice(&self.starts[..self.size]);
        for &(row, column, value) in &self.entries {
            let slot = &mut self.marks[column];
            self.rows[*slot] = row;
            self.values[*slot] = value;
            *slot += 1;
        }
        // In place: the columns only move down.
        self.marks.clear();
        self.marks.resize(self.size, NONE);
        let mut kept = 0;
        for column in 0..self.size {
            let range = self.starts[column]..self.starts[column + 1];
            self.starts[column] = kept;
            let first = kept;
            for slot in range {
                let (row, value) = (self.rows[slot], self.values[slot]);
                let known = self.marks[row];
                if known != NONE && known >= first && known < kept && self.rows[known] == row {
                    self.values[known] += value;
                } else {
                    self.marks[row] = kept;
                    self.rows[kept] = row;
                    self.values[kept] = value;
                    kept += 1;
                }
            }
        }
        self.starts[self.size] = kept;
        self.rows.truncate(kept);
        self.values.truncate(kept);
    }

    /// The elimination tree, and the number of entries of each column of the factor.
    fn grow_tree(&mut self) {
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
            for slot in self.starts[column]..self.starts[column + 1] {
                // From every entry up to the root, as far as this step has not been.
                let mut at = self.place[self.rows[slot]];
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

    /// Row after row of the factor.
    fn eliminate(&mut self) -> bool {
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
            let mut diagonal = self.gather(step);
            // Children come before their parents.
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

    /// Puts a row of the matrix into `row` and the columns that it reaches into `pattern`, parents first. Returns its diagonal.
    fn gather(&mut self, step: usize) -> f64 {
        let mut diagonal = 0.0;
        self.marks[step] = step;
        self.pattern.clear();
        let column = self.order[step];
        for slot in self.starts[column]..self.starts[column + 1] {
            let mut at = self.place[self.rows[slot]];
            if at == step {
                diagonal += self.values[slot];
            } else if at < step {
                self.row[at] += self.values[slot];
                self.path.clear();
                while at < step && self.marks[at] != step {
                    self.path.push(at);
                    self.marks[at] = step;
                    at = self.parents[at];
                }
                // The whole way comes before the ways already there, which start higher up in the tree: so it is taken off first.
                while let Some(at) = self.path.pop() {
                    self.pattern.push(at);
                }
            }
        }
        diagonal
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

    /// Each entry as a block of two by two: in the order of the single rows.
    fn check_pairs(single: &Cholesky) {
        let mut pairs = Cholesky::default();
        pairs.start(2 * single.size);
        let wanted: Vec<f64> = (0..2 * single.size).map(|at| (at as f64 * 0.73).cos()).collect();
        let mut values: Vec<f64> = vec![0.0; 2 * single.size];
        for &(row, column, value) in &single.entries {
            for (i, j, weight) in [(0, 0, 2.0), (1, 1, 3.0), (0, 1, 1.0), (1, 0, 1.0)] {
                pairs.add(2 * row + i, 2 * column + j, weight * value);
                values[2 * row + i] += weight * value * wanted[2 * column + j];
            }
        }
        assert!(pairs.factorise_in_pairs_like(single));
        pairs.solve(&mut values);
        for (found, wanted) in values.iter().zip(&wanted) {
            assert!((found - wanted).abs() < 1e-10);
        }
    }

    #[test]
    fn solves_the_laplacian_of_a_grid_and_refuses_an_indefinite_matrix() {
        let (columns, rows) = (17, 13);
        let size = columns * rows;
        let mut system = Cholesky::default();
        for round in 0..2 {
            system.start(size);
            for at in 0..size {
                system.add(at, at, 0.01);
                let mut edge = |a: usize, b: usize| {
                    for (row, column, value) in [(a, a, 1.0), (b, b, 1.0), (a, b, -1.0), (b, a, -1.0)] {
                        system.add(row, column, value);
                    }
                };
                if at % columns + 1 < columns {
                    edge(at, at + 1);
                }
                if at + columns < size {
                    edge(at, at + columns);
                }
            }
            if round == 1 {
                system.add(5, 5, -9.0);
            }
            assert_eq!(system.factorise(), round == 0);
            if round == 0 {
                let wanted: Vec<f64> = (0..size).map(|at| (at as f64 * 0.37).sin()).collect();
                let mut values: Vec<f64> = vec![0.0; size];
                for (row, column, value) in system.entries.clone() {
                    values[row] += value * wanted[column];
                }
                system.solve(&mut values);
                for (found, wanted) in values.iter().zip(&wanted) {
                    assert!((found - wanted).abs() < 1e-10);
                }
                check_pairs(&system);
            }
        }
    }
}
