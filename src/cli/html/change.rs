//! What a repair did, vertex by vertex.

use nalgebra::{Point3, distance};
use serde::Serialize;

use super::numbers::singles;
use crate::cli::input::Input;

/// How far each vertex moved, and how its edges were stretched.
#[derive(Clone, Debug, Serialize)]
pub(in crate::cli) struct ChangeData {
    /// `num_vertices`, singles, in metres.
    moved_m: String,
    /// `num_vertices`, singles: of the edges of a vertex the stretch (length after divided by length before) farthest
    /// from 1, as a ratio.
    stretch: String,
}

impl ChangeData {
    /// Compares the positions of an input with those `after`, `num_vertices x 3` in metres.
    pub(in crate::cli) fn new(input: &Input, after: &[[f64; 3]]) -> Self {
        let moved = input.positions.iter().zip(after).map(|(&before, &after)| between(before, after));
        Self { moved_m: singles(moved), stretch: singles(stretches(input, after)) }
    }
}

/// For each vertex of the files the stretch of its worst edge; 1 for vertices without an edge that has a length.
pub(super) fn stretches(Input { weld, mesh, positions: before, .. }: &Input, after: &[[f64; 3]]) -> Vec<f64> {
    let mut worst = vec![1.0f64; before.len()];
    for edge in mesh.edge_ids() {
        let ends = mesh.edge(edge);
        let [a, b] = ends.map(|vertex| weld.first(vertex) as usize);
        let length = between(before[a], before[b]);
        if length <= 0.0 {
            continue;
        }
        let ratio = between(after[a], after[b]) / length;
        for vertex in ends {
            for &copy in weld.copies(vertex) {
                let worst = &mut worst[copy as usize];
                if badness(ratio) > badness(*worst) {
                    *worst = ratio;
                }
            }
        }
    }
    worst
}

fn between(a: [f64; 3], b: [f64; 3]) -> f64 {
    distance(&Point3::from(a), &Point3::from(b))
}

/// How far a stretch is from 1, either way: 2 for twice the length and for half of it.
fn badness(ratio: f64) -> f64 {
    ratio.max(1.0 / ratio)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn badness_of_half_and_of_twice_the_length_is_the_same() {
        assert!((badness(0.5) - badness(2.0)).abs() < 1e-15);
        assert!(badness(0.0) > badness(1e-9) && badness(1.0) < badness(1.0 + 1e-9));
    }
}
