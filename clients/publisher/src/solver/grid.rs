//! A spatial hash of boxes (Teschner et al. 2003), rebuilt for each step.

use crate::mesh::Vec3;

/// Which boxes may be near a box. Two boxes that overlap are always reported; others may be. The memory is reused.
#[derive(Clone, Debug, Default)]
pub(super) struct Grid {
    cell_m: f64,
    /// (hash of the cell, item), sorted.
    entries: Vec<(u32, u32)>,
    /// For each bucket where its entries start; one more at the end.
    starts: Vec<u32>,
    mask: u32,
}

/// A box with sides along the axes, in metres.
#[derive(Clone, Copy, Debug)]
pub(super) struct Aabb {
    pub(super) low: Vec3,
    pub(super) high: Vec3,
}

impl Aabb {
    pub(super) fn of<const N: usize>(points: [Vec3; N], margin: f64) -> Self {
        let mut low = points[0];
        let mut high = points[0];
        for point in &points[1..] {
            low = low.inf(point);
            high = high.sup(point);
        }
        Self { low: low.add_scalar(-margin), high: high.add_scalar(margin) }
    }

    pub(super) fn overlaps(&self, other: &Self) -> bool {
        (0..3).all(|axis| self.low[axis] <= other.high[axis] && other.low[axis] <= self.high[axis])
    }
}

impl Grid {
    /// Fills the hash with boxes in order of their index.
    pub(super) fn fill(&mut self, cell_m: f64, boxes: &[Aabb]) {
        self.cell_m = cell_m;
        let buckets = boxes.len().next_power_of_two().max(64) * 2;
        self.mask = u32::try_from(buckets - 1).unwrap_or(u32::MAX >> 1);
        self.entries.clear();
        for (item, aabb) in (0..).zip(boxes) {
            for_each_cell(aabb, cell_m, |cell| self.entries.push((hash(cell) & self.mask, item)));
        }
        self.entries.sort_unstable();
        // A box whose cells share a bucket is entered once.
        self.entries.dedup();
        self.starts.clear();
        let mut entry = 0;
        for bucket in 0..=self.mask + 1 {
            while entry < self.entries.len() && self.entries[entry].0 < bucket {
                entry += 1;
            }
            self.starts.push(u32::try_from(entry).unwrap_or(u32::MAX));
        }
    }

    /// Items whose box may overlap `aabb`, ascending, each once, into `found`.
    pub(super) fn query(&self, aabb: &Aabb, found: &mut Vec<u32>) {
        found.clear();
        for_each_cell(aabb, self.cell_m, |cell| {
            let bucket = (hash(cell) & self.mask) as usize;
            let range = self.starts[bucket] as usize..self.starts[bucket + 1] as usize;
            found.extend(self.entries[range].iter().map(|&(_, item)| item));
        });
        found.sort_unstable();
        found.dedup();
    }
}

fn for_each_cell(aabb: &Aabb, cell_m: f64, mut visit: impl FnMut([i32; 3])) {
    #[expect(clippy::cast_possible_truncation, reason = "saturates; a cell is only a place in the hash")]
    let cell = |value: f64| (value / cell_m).floor() as i32;
    let low = aabb.low.map(cell);
    let high = aabb.high.map(cell);
    for x in low.x..=high.x {
        for y in low.y..=high.y {
            for z in low.z..=high.z {
                visit([x, y, z]);
            }
        }
    }
}

fn hash([x, y, z]: [i32; 3]) -> u32 {
    let mixed = x.cast_unsigned().wrapping_mul(73_856_093)
        ^ y.cast_unsigned().wrapping_mul(19_349_663)
        ^ z.cast_unsigned().wrapping_mul(83_492_791);
    mixed ^ (mixed >> 15)
}
