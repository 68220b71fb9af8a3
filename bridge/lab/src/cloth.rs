//! Cloths that intersect and move.

use untangled_client::Registration;

/// Two square sheets of `n x n` vertices each, one upright in the other.
#[derive(Clone, Copy, Debug)]
pub struct Sheets {
    n: u32,
}

impl Sheets {
    /// Sheets of `n x n` vertices.
    #[must_use]
    pub fn new(n: u32) -> Self {
        Self { n }
    }

    /// Vertices of both.
    #[must_use]
    pub fn num_vertices(&self) -> usize {
        2 * (self.n * self.n) as usize
    }

    /// A registration with defaults for all else.
    #[must_use]
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

    /// Positions of a frame, which are the same in each run. In one frame of eight the sheets are apart.
    #[must_use]
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
                    positions.push(if sheet == 0 {
                        [u, v, wave]
                    } else {
                        [0.31 + 0.4 * u, 0.47 + wave, 0.5 - v + lift]
                    });
                }
            }
        }
        positions
    }

    /// The same in single precision.
    #[must_use]
    pub fn positions_f32(&self, frame: u64) -> Vec<[f32; 3]> {
        self.positions(frame).into_iter().map(|position| position.map(|value| value as f32)).collect()
    }
}

/// One square sheet of `n x n` vertices that is folded over, and goes through itself in waves: tangled in every frame,
/// unless it is asked to be apart.
#[derive(Clone, Copy, Debug)]
pub struct Fold {
    n: u32,
    turns: bool,
    is_apart: bool,
}

impl Fold {
    /// A sheet of `2 (n - 1)^2` triangles.
    #[must_use]
    pub const fn new(n: u32) -> Self {
        Self { n, turns: false, is_apart: false }
    }

    /// The same sheet, and it turns about an oblique axis, so that no two coordinates are alike, as in a simulation.
    #[must_use]
    pub const fn turning(self) -> Self {
        Self { turns: true, ..self }
    }

    /// The same sheet folded over itself without touching itself.
    #[must_use]
    pub const fn apart(self) -> Self {
        Self { is_apart: true, ..self }
    }

    /// A registration with defaults for all else.
    #[must_use]
    pub fn registration(&self) -> Registration {
        let n = self.n;
        let mut triangles = Vec::new();
        for row in 0..n - 1 {
            for column in 0..n - 1 {
                let a = row * n + column;
                triangles.extend([[a, a + 1, a + n], [a + 1, a + n + 1, a + n]]);
            }
        }
        Registration { num_vertices: (n * n) as usize, triangles, ..Registration::default() }
    }

    /// Positions of a frame, which are the same in each run.
    #[must_use]
    pub fn positions(&self, frame: u64) -> Vec<[f64; 3]> {
        let unit = 1.0 / f64::from(self.n - 1);
        let time = (frame % 4096) as f64 / 32.0;
        let mut positions = Vec::with_capacity((self.n * self.n) as usize);
        for row in 0..self.n {
            for column in 0..self.n {
                let (u, v) = (f64::from(row) * unit, f64::from(column) * unit);
                // Round the fold, and back above what lies below; a bump of the upper half dips through the lower one.
                let (x, height) = if u < 0.5 { (u, 0.0) } else { (1.0 - u, 0.06) };
                let place = 0.5 + 0.2 * (0.7 * time).sin();
                let far = ((x - 0.25).powi(2) + (v - place).powi(2)) / 0.004;
                let bump = if u < 0.5 || self.is_apart { 0.0 } else { -0.12 * (-far).exp() };
                let position = [x, v, height + bump + 0.01 * (9.0 * v + time).sin()];
                positions.push(if self.turns { turned(position, 1.0 + 0.2 * time) } else { position });
            }
        }
        positions
    }

    /// The same in single precision.
    #[must_use]
    pub fn positions_f32(&self, frame: u64) -> Vec<[f32; 3]> {
        self.positions(frame).into_iter().map(|position| position.map(|value| value as f32)).collect()
    }
}

/// Turned by an angle about `z`, then about `x`.
fn turned([x, y, z]: [f64; 3], angle: f64) -> [f64; 3] {
    let (sin, cos) = angle.sin_cos();
    let [x, y] = [cos * x - sin * y, sin * x + cos * y];
    [x, cos * y - sin * z, sin * y + cos * z]
}
