//! Sparse symmetric matrices, summed up from triplets into compressed columns.

const NONE: usize = usize::MAX;

/// A matrix of both halves, column by column, and the triplets that it is made of.
#[derive(Debug, Default)]
pub(crate) struct SparseSymmetric {
    size: usize,
    triplets: Vec<(usize, usize, f64)>,
    /// The compressed columns, each entry once, rows in the order in which their first triplets came.
    pub(super) starts: Vec<usize>,
    pub(super) rows: Vec<usize>,
    pub(super) values: Vec<f64>,
    /// Scratch: while triplets are sorted, the next slot of each column; then for each row the slot that it was last
    /// met in.
    marks: Vec<usize>,
}

impl SparseSymmetric {
    /// Begins a matrix of zeros, `size x size`.
    pub(crate) fn start(&mut self, size: usize) {
        self.size = size;
        self.triplets.clear();
    }

    /// Adds to an entry. Both halves of the matrix are to be given.
    pub(crate) fn add(&mut self, row: usize, column: usize, value: f64) {
        self.triplets.push((row, column, value));
    }

    /// Number of rows and of columns.
    pub(super) fn size(&self) -> usize {
        self.size
    }

    /// Makes the compressed columns: sums up the triplets of each entry, in the order in which they came.
    ///
    /// Cost: linear in the triplets.
    pub(crate) fn compress(&mut self) {
        self.sort_into_columns();
        self.marks.clear();
        self.marks.resize(self.size, NONE);
        // In place: columns only move down.
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

    /// Counting sort of the triplets by column.
    fn sort_into_columns(&mut self) {
        self.starts.clear();
        self.starts.resize(self.size + 1, 0);
        for &(_, column, _) in &self.triplets {
            self.starts[column + 1] += 1;
        }
        for column in 0..self.size {
            self.starts[column + 1] += self.starts[column];
        }
        self.rows.clear();
        self.rows.resize(self.triplets.len(), 0);
        self.values.clear();
        self.values.resize(self.triplets.len(), 0.0);
        self.marks.clear();
        self.marks.extend_from_slice(&self.starts[..self.size]);
        for &(row, column, value) in &self.triplets {
            let slot = &mut self.marks[column];
            self.rows[*slot] = row;
            self.values[*slot] = value;
            *slot += 1;
        }
    }
}

#[cfg(test)]
impl SparseSymmetric {
    /// The product with a vector, from the triplets.
    pub(super) fn times(&self, vector: &[f64]) -> Vec<f64> {
        let mut product = vec![0.0; self.size];
        for &(row, column, value) in &self.triplets {
            product[row] += value * vector[column];
        }
        product
    }

    /// The matrix with a positive definite block of two by two in place of each entry.
    pub(super) fn with_blocks(&self) -> Self {
        let mut blocks = Self::default();
        blocks.start(2 * self.size);
        for &(row, column, value) in &self.triplets {
            for (i, j, weight) in [(0, 0, 2.0), (1, 1, 3.0), (0, 1, 1.0), (1, 0, 1.0)] {
                blocks.add(2 * row + i, 2 * column + j, weight * value);
            }
        }
        blocks
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn compress_of_repeated_triplets_sums_each_entry_once() {
        let mut matrix = SparseSymmetric::default();
        for _ in 0..2 {
            matrix.start(2);
            for (row, column, value) in [(1, 0, 4.0), (0, 0, 1.0), (0, 1, 4.0), (0, 0, 2.0), (1, 1, 7.0)] {
                matrix.add(row, column, value);
            }
            matrix.compress();
            assert_eq!((&matrix.starts[..], &matrix.rows[..]), (&[0, 2, 4][..], &[1, 0, 0, 1][..]));
            assert_eq!(matrix.values, [4.0, 3.0, 4.0, 7.0]);
        }
    }
}
