//! How far vertices moved since the last frame, except for a translation that all share.

use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

/// Least number of vertices that one thread takes at a time.
pub(super) const MIN_VERTICES_PER_TASK: usize = 1024;

/// More than the relative rounding of the three or four operations after which it is applied.
pub(super) const ROUNDING: f64 = 1e-15;

/// Displacements from one frame to the next, relative to their mean.
#[derive(Debug, Default)]
pub(super) struct Displacements {
    /// Squared length for each vertex, in square metres.
    squares: Vec<f64>,
    /// The longest displacement, translation included, in metres: what rounding goes by.
    longest_total_m: f64,
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

    /// An upper bound of the length, in metres, from the square as computed. Squares that underflow to zero are of
    /// lengths below 1e-160 metres.
    pub(super) fn bound_m(&self, square: f64) -> f64 {
        square.sqrt() * (1.0 + ROUNDING) + ROUNDING * self.longest_total_m + 1e-150
    }

    /// Measures displacements from `previous`, which becomes a copy of `positions`; an upper bound of the longest, in
    /// metres.
    ///
    /// Cost: linear in the vertices, in parallel.
    pub(super) fn measure(&mut self, previous: &mut [Point3<f64>], positions: &[Point3<f64>]) -> f64 {
        let translation = mean_displacement(previous, positions);
        let squares = self.squares.par_chunks_mut(MIN_VERTICES_PER_TASK);
        let previous = previous.par_chunks_mut(MIN_VERTICES_PER_TASK);
        let chunks = squares.zip(previous).zip(positions.par_chunks(MIN_VERTICES_PER_TASK));
        let of_chunks = chunks.map(|((squares, previous), positions)| {
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
