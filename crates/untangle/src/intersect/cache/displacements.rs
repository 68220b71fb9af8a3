//! How far vertices moved since the last frame, except for a translation that all share. Bodies that stay share none,
//! and are not looked at.

use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

use crate::mesh::{Mesh, VERTICES_PER_BLOCK};

/// More than the relative rounding of the three or four operations after which it is applied.
pub(super) const ROUNDING: f64 = 1e-15;

/// Displacements from one frame to the next, relative to their mean.
#[derive(Debug, Default)]
pub(super) struct Displacements {
    /// Squared length for each vertex, in square metres.
    squares: Vec<f64>,
    /// The longest displacement, translation included, in metres: what rounding goes by.
    longest_total_m: f64,
    /// Whether there are bodies, no vertex of which has moved.
    are_bodies_still: bool,
}

impl Displacements {
    pub(super) fn resize(&mut self, num_vertices: usize) {
        self.squares.resize(num_vertices, 0.0);
    }

    /// The squared length of a vertex' displacement in square metres, as computed.
    #[inline]
    pub(super) fn square(&self, vertex: usize) -> f64 {
        self.squares[vertex]
    }

    /// Whether there are bodies, no vertex of which has moved: their displacements are zero.
    pub(super) fn are_bodies_still(&self) -> bool {
        self.are_bodies_still
    }

    /// An upper bound of the length, in metres, from the square as computed. Squares that underflow to zero are of
    /// lengths below 1e-160 metres.
    pub(super) fn bound_m(&self, square: f64) -> f64 {
        square.sqrt() * (1.0 + ROUNDING) + ROUNDING * self.longest_total_m + 1e-150
    }

    /// Measures displacements from `previous`, which becomes a copy of `positions`; an upper bound of the longest, in
    /// metres. Blocks of vertices of bodies that are still are passed over: there the two are the same.
    ///
    /// Cost: linear in the vertices, in parallel.
    pub(super) fn measure(
        &mut self,
        mesh: &Mesh,
        previous: &mut [Point3<f64>],
        positions: &[Point3<f64>],
        are_bodies_still: bool,
    ) -> f64 {
        let were_bodies_still = std::mem::replace(&mut self.are_bodies_still, are_bodies_still);
        let translation = if are_bodies_still { Vector3::zeros() } else { mean_displacement(previous, positions) };
        let squares = self.squares.par_chunks_mut(VERTICES_PER_BLOCK);
        let previous = previous.par_chunks_mut(VERTICES_PER_BLOCK);
        let chunks = squares.zip(previous).zip(positions.par_chunks(VERTICES_PER_BLOCK));
        let of_chunks = chunks.enumerate().map(|(block, ((squares, previous), positions))| {
            if are_bodies_still && mesh.is_body_block(block) {
                if !were_bodies_still {
                    squares.fill(0.0);
                }
                return (0.0, 0.0);
            }
            let (mut longest, mut longest_total) = (0.0, 0.0);
            for ((square, before), now) in squares.iter_mut().zip(previous).zip(positions) {
                let moved = now - *before;
                let relative = moved - translation;
                *square = relative.dot(&relative);
                *before = *now;
                let total = moved.x.abs() + moved.y.abs() + moved.z.abs();
                longest = if *square > longest { *square } else { longest };
                longest_total = if total > longest_total { total } else { longest_total };
            }
            (longest, longest_total)
        });
        let (longest, longest_total) = of_chunks.reduce(|| (0.0, 0.0), |a: (f64, f64), b| (a.0.max(b.0), a.1.max(b.1)));
        self.longest_total_m = longest_total;
        self.bound_m(longest)
    }
}

/// Of some 512 vertices: any translation is right, and that of some is close to the best one.
fn mean_displacement(previous: &[Point3<f64>], positions: &[Point3<f64>]) -> Vector3<f64> {
    let stride = positions.len() / 512 + 1;
    let samples = positions.iter().zip(previous).step_by(stride);
    let (sum, count) =
        samples.fold((Vector3::zeros(), 0.0), |(sum, count), (now, before)| (sum + (now - before), count + 1.0));
    if count > 0.0 { sum / count } else { sum }
}
