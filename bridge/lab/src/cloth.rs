//! Cloths that intersect and move.

use untangled_client::Registration;

/// Two square sheets of `n x n` vertices each, one upright in the other.
pub struct Sheets {
    n: u32,
}

impl Sheets {
    pub fn new(n: u32) -> Self {
        Self { n }
    }

    pub fn num_vertices(&self) -> usize {
        2 * (self.n * self.n) as usize
    }

    pub fn registration(&self) -> Registration {
        let n = self.n;
        let mut triangles = Vec::new();
        for first in [0, n * n] {
            for row in 0..n - 1 {
                for column in 0..n - 1 {
                    let a = first + row * n + column;
                    triangles.extend([[a, a + 1, a + n], [a + 1, a + n + 1, a + n]]);
                }
            }
        }
        Registration { num_vertices: self.num_vertices(), triangles, ..Registration::default() }
    }

    /// Positions of a frame. In one frame of eight the sheets are apart.
    pub fn positions(&self, frame: u64) -> Vec<[f64; 3]> {
        let n = self.n;
        let time = frame as f64 / 16.0;
        let lift = if frame % 8 == 7 { 3.0 } else { 0.3 * time.sin() };
        let unit = 1.0 / f64::from(n - 1);
        let mut positions = Vec::with_capacity(self.num_vertices());
        for sheet in 0..2 {
            for row in 0..n {
                for column in 0..n {
                    let (u, v) = (f64::from(row) * unit, f64::from(column) * unit);
                    let wave = 0.07 * (5.0 * u + time).sin() * (4.0 * v - time).cos();
                    positions.push(if sheet == 0 { [u, v, wave] } else { [0.31 + 0.4 * u, 0.47 + wave, 0.5 - v + lift] });
                }
            }
        }
        positions
    }

    pub fn positions_f32(&self, frame: u64) -> Vec<[f32; 3]> {
        self.positions(frame).into_iter().map(|position| position.map(|value| value as f32)).collect()
    }
}
