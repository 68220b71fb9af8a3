//! Solutions with a factor.

use nalgebra::Vector3;

use super::Cholesky;

impl Cholesky {
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
                rows[row as usize] -= value * factor;
            }
        }
        for column in (0..self.size).rev() {
            let (start, end) = columns(column);
            let mut value = rows[column];
            for (&row, &factor) in self.factor_rows[start + 1..end].iter().zip(&self.factor_values[start + 1..end]) {
                value -= rows[row as usize] * factor;
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
            for (&row, &factor) in self.factor_rows[start + 1..end].iter().zip(&self.factor_values[start + 1..end]) {
                self.row[row as usize] -= factor * value;
            }
        }
        for column in (0..self.size).rev() {
            let (start, end) = (self.factor_starts[column], self.factor_starts[column + 1]);
            let mut value = self.row[column];
            for (&row, &factor) in self.factor_rows[start + 1..end].iter().zip(&self.factor_values[start + 1..end]) {
                value -= factor * self.row[row as usize];
            }
            self.row[column] = value / self.factor_values[start];
        }
        for (&value, &vertex) in self.row.iter().zip(&self.order) {
            values[vertex] = value;
        }
    }
}
