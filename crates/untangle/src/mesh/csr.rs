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
        let mut csr = Self::default();
        csr.fill(num_rows, pairs);
        csr
    }

    /// The same, in the memory that is there.
    pub(crate) fn fill(&mut self, num_rows: usize, pairs: impl Iterator<Item = (usize, T)> + Clone) {
        // While items are filled in, entry k + 1 says where the next one of row k goes; then that is where row k ends.
        self.offsets.clear();
        self.offsets.resize(num_rows + 2, 0);
        for (row, _) in pairs.clone() {
            self.offsets[row + 2] += 1;
        }
        for row in 0..num_rows {
            self.offsets[row + 2] += self.offsets[row + 1];
        }
        self.items.clear();
        self.items.resize(self.offsets[num_rows + 1] as usize, T::default());
        for (row, item) in pairs {
            let slot = &mut self.offsets[row + 1];
            self.items[*slot as usize] = item;
            *slot += 1;
        }
        self.offsets.truncate(num_rows + 1);
    }

    /// The list of one row.
    pub(crate) fn row(&self, row: usize) -> &[T] {
        &self.items[self.offsets[row] as usize..self.offsets[row + 1] as usize]
    }
}
