//! A sheet folded in half, whose upper layer hangs through the lower one in long narrow furrows: as many paths as wanted, each with few vertices
//! inside for its length, as in draped cloth. Crumpled sheets have wide ones.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::sheet::{Sheet, grid};

/// Between the layers, in squares of the sheet.
const GAP: f64 = 2.0;
/// Depth of a furrow as a multiple of the gap.
const DEPTH: f64 = 1.6;

/// Furrows in rows and columns, and where they end, in squares of the sheet from their middle, along and across.
#[derive(Clone, Copy)]
pub(crate) struct Furrows {
    pub(crate) rows: u32,
    pub(crate) columns: u32,
    pub(crate) along: f64,
    pub(crate) across: f64,
}

/// A sheet of `resolution x resolution` squares of side 1 / `resolution` metres.
pub(crate) fn folded(seed: u64, resolution: u32, furrows: Furrows) -> Sheet {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let (faces, uvs) = grid(resolution, &mut rng);
    let edge = 1.0 / f64::from(resolution);
    let places: Vec<([f64; 2], f64)> = (0..furrows.rows * furrows.columns)
        .map(|number| {
            let (row, column) = (f64::from(number / furrows.columns), f64::from(number % furrows.columns));
            let mut jitter = || edge * rng.random_range(-0.2..0.2);
            let u = (column + 0.5) / f64::from(furrows.columns) + jitter();
            // Away from the crease, where the layers join.
            let v = 0.01 + 0.46 * (row + 0.5) / f64::from(furrows.rows) + jitter();
            ([u, v], rng.random_range(-0.05..0.05))
        })
        .collect();
    let depth_at = |[u, v]: [f64; 2]| {
        let deepest = places.iter().map(|&([x, y], turn)| {
            let (along, across) = ((u - x) + turn * (v - y), (v - y) - turn * (u - x));
            let reach = (along / (edge * furrows.along)).powi(2) + (across / (edge * furrows.across)).powi(2);
            // 1 in the middle and 1 / DEPTH on the ellipse, so that the layers meet there.
            1.0 - reach * (1.0 - 1.0 / DEPTH)
        });
        deepest.fold(0.0, f64::max)
    };
    let (radius, gap) = (0.5 * GAP * edge, GAP * edge);
    let half_turn = std::f64::consts::PI * radius;
    let positions = uvs.iter().map(|&[u, v]| {
        let beyond = v - 0.5;
        let [y, z] = if beyond <= 0.0 {
            [v, 0.0]
        } else if beyond < half_turn {
            let angle = beyond / radius;
            [0.5 + radius * angle.sin(), radius * (1.0 - angle.cos())]
        } else {
            let y = 0.5 + half_turn - beyond;
            [y, gap - DEPTH * gap * depth_at([u, y])]
        };
        // The upper layer slid aside and all of it bent, so that no edges and no faces of the two lie in one plane.
        [u + 0.31 * z, y, z + 0.02 * (3.0 * u + y).sin() + 0.01 * (7.0 * y).cos()]
    });
    Sheet { positions: positions.collect(), faces, uvs }
}
