//! Clocks of sets of vertices.

use rayon::prelude::*;

use super::displacements::{Displacements, ROUNDING};
use crate::mesh::{Mesh, VERTICES_PER_BLOCK, VertexId};

/// Sets of vertices, each with a clock that shows an upper bound of the distance that any of its vertices has moved, in
/// metres.
#[derive(Debug, Default)]
pub(super) struct Clocks {
    offsets: Vec<u32>,
    vertices: Vec<VertexId>,
    times_m: Vec<f64>,
    /// For each set whether all of its vertices are those of bodies.
    are_bodies: Vec<bool>,
}

impl Clocks {
    /// Adds the set of the given vertices, which are drained.
    pub(super) fn push(&mut self, mesh: &Mesh, vertices: &mut Vec<VertexId>) {
        vertices.sort_unstable();
        vertices.dedup();
        self.are_bodies.push(vertices.iter().all(|&vertex| mesh.is_body(vertex)));
        if self.offsets.is_empty() {
            self.offsets.push(0);
        }
        self.vertices.append(vertices);
        self.offsets.push(u32::try_from(self.vertices.len()).expect("fewer than three for each face"));
        self.times_m.push(0.0);
    }

    /// Sets all clocks to zero.
    pub(super) fn reset(&mut self) {
        self.times_m.fill(0.0);
    }

    /// Advances each clock by the largest displacement in its set.
    pub(super) fn advance(&mut self, displacements: &Displacements) {
        let (offsets, vertices, are_bodies) = (&self.offsets, &self.vertices, &self.are_bodies);
        let are_bodies_still = displacements.are_bodies_still();
        self.times_m.par_iter_mut().with_min_len(VERTICES_PER_BLOCK / 8).enumerate().for_each(|(set, time_m)| {
            if are_bodies_still && are_bodies[set] {
                return;
            }
            let of_set = &vertices[offsets[set] as usize..offsets[set + 1] as usize];
            let longest = of_set.iter().fold(0.0, |longest, vertex| {
                let square = displacements.square(vertex.index());
                if square > longest { square } else { longest }
            });
            *time_m = (*time_m + displacements.bound_m(longest)) * (1.0 + ROUNDING);
        });
    }

    pub(super) fn times_m(&self) -> &[f64] {
        &self.times_m
    }

    /// The clock that has advanced most.
    pub(super) fn latest_m(&self) -> f64 {
        self.times_m.iter().copied().fold(0.0, f64::max)
    }
}
