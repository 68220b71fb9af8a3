//! A sheet folded in half, whose upper layer hangs through the lower one in long narrow furrows.
//!
//! It has as many paths as wanted, each with few vertices inside for its length, as in draped cloth; regions of
//! crumpled sheets are wide.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::{Sheet, squares};

/// Between the layers, in squares of the sheet.
const GAP: f64 = 2.0;
/// Depth of a furrow as a multiple of the gap.
const DEPTH: f64 = 1.6;

/// Furrows in rows and columns.
#[derive(Clone, Copy, Debug)]
pub struct Furrows {
    /// Number of rows, from the edge of the sheet to the crease.
    pub rows: u32,
    /// Number of columns along the crease.
    pub columns: u32,
    /// From the middle of a furrow to its ends, in squares of the sheet.
    pub along: f64,
    /// From the middle of a furrow to its sides, in squares of the sheet.
    pub across: f64,
}

/// A sheet of `resolution x resolution` squares of side 1 / `resolution` metres.
pub fn folded(seed: u64, resolution: u32, furrows: Furrows) -> Sheet {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let (faces, uvs) = squares(resolution, &mut rng);
    let edge = 1.0 / f64::from(resolution);
    let places = places(edge, furrows, &mut rng);
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

/// Middles of the furrows, each with the tangent of its angle to the crease.
fn places(edge: f64, furrows: Furrows, rng: &mut ChaCha8Rng) -> Vec<([f64; 2], f64)> {
    (0..furrows.rows * furrows.columns)
        .map(|number| {
            let (row, column) = (f64::from(number / furrows.columns), f64::from(number % furrows.columns));
            let mut jitter = || edge * rng.random_range(-0.2..0.2);
            let u = (column + 0.5) / f64::from(furrows.columns) + jitter();
            // Away from the crease, where the layers join.
            let v = 0.01 + 0.46 * (row + 0.5) / f64::from(furrows.rows) + jitter();
            ([u, v], rng.random_range(-0.05..0.05))
        })
        .collect()
}
