//! A grid over the plane across a direction, to find the triangles whose shadows overlap.

use super::triangle::SeenTriangle;

/// The triangles of the second sheet by cells of the plane across.
#[derive(Debug, Default)]
pub(super) struct Grid {
    low: [f64; 2],
    cell: f64,
    size: [usize; 2],
    starts: Vec<u32>,
    members: Vec<u32>,
}

impl Grid {
    /// Sorts triangles into cells of about their size.
    pub(super) fn fill(&mut self, triangles: &[SeenTriangle]) {
        let (mut low, mut high, mut extent) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2], 0.0);
        for triangle in triangles {
            for k in 0..2 {
                low[k] = low[k].min(triangle.low[k]);
                high[k] = high[k].max(triangle.high[k]);
                extent += 0.5 * (triangle.high[k] - triangle.low[k]);
            }
        }
        #[expect(clippy::cast_precision_loss, reason = "a count")]
        let count = triangles.len().max(1) as f64;
        let largest = (0..2).map(|k| high[k] - low[k]).fold(0.0, f64::max);
        // No more cells along an axis than a few thousand, whatever the shapes are.
        self.cell = (extent / count).max(largest / (4.0 * count.sqrt() + 16.0)).max(f64::MIN_POSITIVE);
        self.low = low;
        self.size = [0, 1].map(|k| index((high[k] - low[k]) / self.cell) + 1);
        let num_cells = self.size[0] * self.size[1];
        self.starts.clear();
        self.starts.resize(num_cells + 1, 0);
        let mut members = Vec::new();
        for (number, triangle) in (0u32..).zip(triangles) {
            self.for_cells(triangle.low, triangle.high, |cell| members.push((cell, number)));
        }
        for &(cell, _) in &members {
            self.starts[cell + 1] += 1;
        }
        for cell in 0..num_cells {
            self.starts[cell + 1] += self.starts[cell];
        }
        let mut next = self.starts.clone();
        self.members.clear();
        self.members.resize(members.len(), 0);
        for (cell, number) in members {
            self.members[next[cell] as usize] = number;
            next[cell] += 1;
        }
    }

    /// Calls `seen` with the triangles in the cells of another one, and the cell.
    pub(super) fn visit(&self, triangle: &SeenTriangle, mut seen: impl FnMut(u32, usize)) {
        self.for_cells(triangle.low, triangle.high, |cell| {
            for &member in &self.members[self.starts[cell] as usize..self.starts[cell + 1] as usize] {
                seen(member, cell);
            }
        });
    }

    fn for_cells(&self, low: [f64; 2], high: [f64; 2], mut act: impl FnMut(usize)) {
        if (0..2).any(|k| high[k] < self.low[k]) {
            return;
        }
        let first = [0, 1].map(|k| index((low[k] - self.low[k]) / self.cell));
        let last = [0, 1].map(|k| index((high[k] - self.low[k]) / self.cell).min(self.size[k] - 1));
        for row in first[1]..=last[1] {
            for column in first[0]..=last[0] {
                act(row * self.size[0] + column);
            }
        }
    }

    /// The cell of a place.
    pub(super) fn cell_of(&self, place: [f64; 2]) -> usize {
        let [column, row] = [0, 1].map(|k| index((place[k] - self.low[k]) / self.cell).min(self.size[k] - 1));
        row * self.size[0] + column
    }
}

/// The whole part of a number, 0 for what is negative or none.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the conversion saturates")]
fn index(value: f64) -> usize {
    value as usize
}
