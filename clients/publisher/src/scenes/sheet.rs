//! A rectangle of cloth, before it is bent into a scene.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::mesh::{Cloth, Uvs, Vec3};

/// The pinned vertices of a sheet.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Pin {
    /// None.
    #[default]
    Nothing,
    /// The whole boundary.
    Boundary,
    /// The side u = 0.
    Left,
    /// The middle of the side v = height, as by a peg.
    Peg,
    /// The boundary where u is at most this, in metres.
    UpTo(f64),
}

/// A flat rectangular sheet of `width x height` metres with triangles of about `edge_m`.
#[derive(Clone, Copy, Debug)]
pub struct Sheet {
    width_m: f64,
    height_m: f64,
    columns: u32,
    rows: u32,
    pin: Pin,
}

/// Largest offset of an inner vertex from its place in the grid, in cells, so that no two sheets are aligned.
const JITTER: f64 = 0.15;

impl Sheet {
    /// A free sheet.
    #[must_use]
    pub fn new(width_m: f64, height_m: f64, edge_m: f64) -> Self {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates; clamped")]
        let cells = |length: f64| ((length / edge_m).round() as u32).clamp(2, 2000);
        Self { width_m, height_m, columns: cells(width_m), rows: cells(height_m), pin: Pin::Nothing }
    }

    /// The same sheet with pins.
    #[must_use]
    pub fn pinned(self, pin: Pin) -> Self {
        Self { pin, ..self }
    }

    /// The number of cells in each direction made even, so that a row of vertices runs through the middle.
    #[must_use]
    pub fn with_middle(self) -> Self {
        Self { columns: self.columns.next_multiple_of(2), rows: self.rows.next_multiple_of(2), ..self }
    }

    /// Puts the sheet into the world by a map from its `u` in `0..=width` and `v` in `0..=height`. The grid is jittered
    /// inside, and the diagonals are random.
    #[must_use]
    pub fn build(self, seed: u64, map: impl Fn(f64, f64) -> Vec3) -> Cloth {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut cloth = Cloth { flat_hinges: true, ..Cloth::default() };
        let mut coordinates = Vec::new();
        for row in 0..=self.rows {
            for column in 0..=self.columns {
                let inside = column > 0 && column < self.columns && row > 0 && row < self.rows;
                // The middle is not jittered, since scenes put loop vertices there.
                let middle = 2 * column == self.columns && 2 * row == self.rows;
                let mut jitter = || rng.random_range(-JITTER..JITTER) * f64::from(u8::from(inside && !middle));
                let u = (f64::from(column) + jitter()) / f64::from(self.columns) * self.width_m;
                let v = (f64::from(row) + jitter()) / f64::from(self.rows) * self.height_m;
                if self.holds(column, row) {
                    cloth.pins.push(self.vertex(column, row));
                }
                cloth.positions.push(map(u, v));
                cloth.rest_positions.push(Vec3::new(u, v, 0.0));
                coordinates.push([u, v]);
            }
        }
        for row in 0..self.rows {
            for column in 0..self.columns {
                let [a, b] = [self.vertex(column, row), self.vertex(column + 1, row)];
                let [d, c] = [self.vertex(column, row + 1), self.vertex(column + 1, row + 1)];
                let halves = if rng.random_bool(0.5) { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] };
                cloth.triangles.extend(halves);
            }
        }
        cloth.uvs = Some(Uvs { coordinates, corners: cloth.triangles.clone() });
        cloth
    }

    fn vertex(&self, column: u32, row: u32) -> u32 {
        row * (self.columns + 1) + column
    }

    fn holds(&self, column: u32, row: u32) -> bool {
        let (left, right) = (column == 0, column == self.columns);
        let (bottom, top) = (row == 0, row == self.rows);
        match self.pin {
            Pin::Nothing => false,
            Pin::Boundary => left || right || bottom || top,
            Pin::Left => left,
            Pin::Peg => top && (2 * column).abs_diff(self.columns) <= 1,
            Pin::UpTo(limit) => {
                left || ((bottom || top) && f64::from(column) / f64::from(self.columns) * self.width_m <= limit)
            }
        }
    }
}
