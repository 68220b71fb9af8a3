//! Lists of varying length in two flat arrays.

/// For each row a list of ids: compressed rows.
#[derive(Clone, Debug, Default)]
pub(crate) struct Csr<T> {
    offsets: Vec<u32>,
    items: Vec<T>,
}

impl<T: Copy + Default> Csr<T> {
    /// Collects `(row, item)` pairs; within a row the order of the pairs is kept.
    pub(crate) fn from_pairs(num_rows: usize, pairs: impl Iterator<Item = (usize, T)> + Clone) -> Self {
        let mut offsets = vec![0u32; num_rows + 1];
        for (row, _) in pairs.clone() {
            offsets[row + 1] += 1;
        }
        for row in 0..num_rows {
            offsets[row + 1] += offsets[row];
        }
        let mut cursor = offsets.clone();
        let mut items = vec![T::default(); offsets[num_rows] as usize];
        for (row, item) in pairs {
            items[cursor[row] as usize] = item;
            cursor[row] += 1;
        }
        Self { offsets, items }
    }

    /// The list of one row.
    pub(crate) fn row(&self, row: usize) -> &[T] {
        &self.items[self.offsets[row] as usize..self.offsets[row + 1] as usize]
    }
}
