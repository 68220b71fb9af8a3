//! Tangled pieces for tests.

use std::f64::consts::TAU;

use crate::{
    frame::Frame,
    mesh::{Mesh, MeshDescription},
};

/// Pieces of one mesh.
#[derive(Default)]
pub(in crate::relax) struct Pieces {
    pub(in crate::relax) positions: Vec<[f64; 3]>,
    faces: Vec<[u32; 3]>,
}

impl Pieces {
    /// Adds a patch of squares, each split in two, at `place` of its two coordinates from 0 to 1; where it closes, its
    /// last column is its first.
    fn add(&mut self, [columns, rows]: [u32; 2], closes: bool, place: impl Fn(f64, f64) -> [f64; 3]) {
        let first = u32::try_from(self.positions.len()).unwrap();
        let width = if closes { columns } else { columns + 1 };
        for row in 0..=rows {
            let v = f64::from(row) / f64::from(rows);
            self.positions.extend((0..width).map(|column| place(f64::from(column) / f64::from(columns), v)));
        }
        for row in 0..rows {
            for column in 0..columns {
                let at = |column: u32, row: u32| first + row * width + column % width;
                let [a, b, c, d] = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(i, j)| at(column + i, row + j));
                self.faces.extend([[a, b, c], [a, c, d]]);
            }
        }
    }

    /// A strip that sticks through a level sheet of `squares x squares` squares by a distance.
    pub(in crate::relax) fn tongue(squares: u32, out_m: f64) -> Self {
        let mut pieces = Self::default();
        pieces.add([squares, squares], false, |u, v| [2.0 * u - 1.0, 2.0 * v - 1.0, 0.01 * (5.0 * u + 3.0 * v).sin()]);
        pieces.add([squares / 4, squares / 2], false, |u, v| {
            [0.4 * u - 0.211, 0.013 + 0.02 * v, out_m - 1.1 * v + 0.003 * u]
        });
        pieces
    }

    /// Two tubes that cross at right angles, the upper one sunk into the lower one by a third of their radius.
    pub(in crate::relax) fn tubes(squares: u32) -> Self {
        let mut pieces = Self::default();
        let tube = |u: f64, v: f64| [1.203 * (2.0 * v - 1.0), 0.3 * (TAU * u).cos(), 0.3 * (TAU * u).sin()];
        pieces.add([squares, 2 * squares], true, tube);
        pieces.add([squares, 2 * squares], true, |u, v| {
            let [x, y, z] = tube(u, v);
            [0.017 + y, 0.023 + x, 0.5 + z]
        });
        pieces
    }

    /// A sheet with a finger that goes through a second sheet.
    pub(in crate::relax) fn finger(squares: u32) -> Self {
        let mut pieces = Self::default();
        pieces.add([squares, squares], false, |u, v| {
            let [x, y] = [2.0 * u - 1.0, 2.0 * v - 1.0];
            [x, y, 0.9 * (-(x * x + y * y) / 0.05).exp()]
        });
        pieces.add([squares, squares], false, |u, v| [2.0 * u - 1.017, 2.0 * v - 0.989, 0.4 + 0.01 * (4.0 * u).sin()]);
        pieces
    }

    /// A sleeve within another one of the same radius, of which a third lies too far in: up to `depth_m` deep.
    pub(in crate::relax) fn sleeves(squares: u32, depth_m: f64) -> Self {
        let mut pieces = Self::default();
        let tube = |u: f64, v: f64, radius_m: f64| {
            [2.0 * v - 1.0, radius_m * (TAU * (u + 0.01)).cos(), radius_m * (TAU * u).sin()]
        };
        pieces.add([squares, squares], true, |u, v| tube(u, v, 0.4));
        pieces.add([squares, squares], true, |u, v| {
            let wave = (2.0 * TAU * u + 3.0 * v).sin() * (7.0 * v + TAU * u).cos();
            tube(u + 0.003, 0.02 + 0.96 * v, 0.4 + depth_m * (0.3 + 1.3 * wave))
        });
        pieces
    }

    /// A folded sheet of which the two layers cross each other as a pair of scissors does, from the fold to the
    /// boundary, and lie up to twice `depth_m` behind each other.
    pub(in crate::relax) fn scissors(squares: u32, depth_m: f64) -> Self {
        let mut pieces = Self::default();
        pieces.add([squares, squares], false, |u, v| {
            let [u, v] = [1.6 * u - 0.793, 1.6 * v - 0.807];
            [u * u, v, depth_m * v * (u / 0.2).tanh()]
        });
        pieces
    }

    pub(in crate::relax) fn mesh(&self) -> (Mesh, Frame) {
        let description =
            MeshDescription { num_vertices: self.positions.len(), faces: self.faces.clone(), ..Default::default() };
        let mesh = Mesh::new(description).unwrap();
        let frame = Frame::new(&mesh, &self.positions).unwrap();
        (mesh, frame)
    }
}
