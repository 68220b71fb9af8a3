//! A uniform grid over a part of the plane: the cells that a box covers, and the rings of cells round one.

use nalgebra::{Point2, Vector2};

/// Square cells, numbered row by row. Points outside belong to the nearest cell of the border.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid {
    low: Point2<f64>,
    pub(super) cell: f64,
    cells_per_length: f64,
    columns: usize,
    rows: usize,
}

impl Default for Grid {
    fn default() -> Self {
        Self::over(std::iter::empty(), 0)
    }
}

impl Grid {
    /// About `num_cells` cells over the box of some points.
    pub(super) fn over<'a>(points: impl Iterator<Item = &'a Point2<f64>>, num_cells: usize) -> Self {
        let box_of = |(low, high): (Point2<f64>, Point2<f64>), point: &Point2<f64>| (low.inf(point), high.sup(point));
        let nothing = (Point2::new(f64::INFINITY, f64::INFINITY), Point2::new(f64::NEG_INFINITY, f64::NEG_INFINITY));
        let (low, high) = points.fold(nothing, box_of);
        let (low, extent) = if low.x <= high.x { (low, high - low) } else { (Point2::origin(), Vector2::zeros()) };
        let count = as_float(num_cells.max(1));
        let side = extent.x.max(extent.y);
        let cell = (extent.x * extent.y / count).sqrt().max(side / count).max(f64::MIN_POSITIVE);
        let cells_per_length = 1.0 / cell;
        let count_along = |length: f64| whole(length * cells_per_length) + 1;
        Self { low, cell, cells_per_length, columns: count_along(extent.x), rows: count_along(extent.y) }
    }

    pub(super) fn num_cells(&self) -> usize {
        self.columns * self.rows
    }

    /// The largest number of rings round a cell, the cell itself counted as the first.
    pub(super) fn num_rings(&self) -> usize {
        self.columns.max(self.rows)
    }

    /// Column and row of a point.
    pub(super) fn place(&self, point: Point2<f64>) -> (usize, usize) {
        let at = (point - self.low) * self.cells_per_length;
        (whole(at.x).min(self.columns - 1), whole(at.y).min(self.rows - 1))
    }

    /// The cell of a point.
    pub(super) fn cell_of(&self, point: Point2<f64>) -> usize {
        let (column, row) = self.place(point);
        row * self.columns + column
    }

    /// Visits the cells that a box covers, row by row.
    #[inline]
    pub(super) fn for_cells(&self, low: Point2<f64>, high: Point2<f64>, mut visit: impl FnMut(usize)) {
        let (low, high) = (self.place(low), self.place(high));
        for row in low.1..=high.1 {
            for column in low.0..=high.0 {
                visit(row * self.columns + column);
            }
        }
    }

    /// The cells that are `ring` columns or rows away from one, whichever is more.
    pub(super) fn ring(self, (column, row): (usize, usize), ring: usize) -> impl Iterator<Item = usize> {
        let rows = row.saturating_sub(ring)..=(row + ring).min(self.rows - 1);
        rows.flat_map(move |at| {
            let (first, last) = (column.checked_sub(ring), (column + ring < self.columns).then_some(column + ring));
            // The top and the bottom row belong to the ring as a whole, of others the two ends.
            let whole = at.abs_diff(row) == ring;
            let all = column.saturating_sub(ring)..=(column + ring).min(self.columns - 1);
            let ends = [first, last].into_iter().flatten();
            let cells = all.filter(move |_| whole).chain(ends.filter(move |_| !whole));
            cells.map(move |column| at * self.columns + column)
        })
    }

    /// The vector from the nearest point of the grid's box to a point: zero within the box.
    pub(super) fn offset_from_box(&self, point: Point2<f64>) -> Vector2<f64> {
        let high = self.low + Vector2::new(self.cell * as_float(self.columns), self.cell * as_float(self.rows));
        point - point.inf(&high).sup(&self.low)
    }
}

#[expect(clippy::cast_precision_loss, reason = "a count of cells")]
pub(super) fn as_float(count: usize) -> f64 {
    count as f64
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the cast saturates, as it should")]
fn whole(value: f64) -> usize {
    value.max(0.0) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grid_rings_round_any_cell_cover_each_cell_once() {
        let corners = [Point2::new(0.0, 0.0), Point2::new(0.7, 0.4)];
        let grid = Grid::over(corners.iter(), 28);
        for start in [Point2::new(0.0, 0.0), Point2::new(0.33, 0.21), Point2::new(9.0, 0.3)] {
            let rings = (0..grid.num_rings()).flat_map(|ring| grid.ring(grid.place(start), ring));
            let mut cells: Vec<usize> = rings.collect();
            cells.sort_unstable();
            assert_eq!(cells, (0..grid.num_cells()).collect::<Vec<_>>());
        }
        let mut count = 0;
        grid.for_cells(corners[0], corners[1], |_| count += 1);
        assert_eq!(count, grid.num_cells());
    }
}
