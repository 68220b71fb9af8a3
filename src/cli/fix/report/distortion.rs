//! How much a repair changed the shape of the cloth.

use nalgebra::Point3;
use serde::Serialize;

use untangle::relax::STRETCH_LIMIT;

use crate::cli::input::Input;

/// Displacements and stretch between two states of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Distortion {
    /// Vertices that moved at all; all others are what they were, to the bit.
    pub num_moved_vertices: usize,
    /// Largest displacement of a vertex, in metres.
    pub max_displacement_m: f64,
    /// Mean displacement of all vertices, in metres.
    pub mean_displacement_m: f64,
    /// Stretch (length after divided by length before) of the edge with the largest |log| of it; 0 for an edge that
    /// collapsed.
    pub max_edge_stretch: f64,
    /// Edges with a stretch beyond [`STRETCH_LIMIT`] or below its inverse.
    pub num_overstretched_edges: usize,
    /// Mean stretch of all edges.
    pub mean_edge_stretch: f64,
}

impl Distortion {
    /// Compares the positions of an input with those `after`, `num_vertices x 3` in metres. Edges without length before
    /// have no stretch and are left out; without any edge the stretch is 1.
    pub(in crate::cli) fn new(Input { weld, mesh, positions: before, .. }: &Input, after: &[[f64; 3]]) -> Self {
        let distance = |a: [f64; 3], b: [f64; 3]| nalgebra::distance(&Point3::from(a), &Point3::from(b));
        let (mut largest, mut sum, mut num_vertices, mut num_moved_vertices) = (0.0f64, 0.0, 0, 0);
        // Bodies come last, and don't move.
        let is_cloth = |&(vertex, _): &(u32, _)| !mesh.is_body(weld.of(vertex));
        for (_, (&before, &after)) in (0..).zip(before.iter().zip(after)).take_while(is_cloth) {
            num_vertices += 1;
            num_moved_vertices += usize::from(before.map(f64::to_bits) != after.map(f64::to_bits));
            let displacement = distance(before, after);
            largest = largest.max(displacement);
            sum += displacement;
        }
        let (mut worst, mut ratios, mut count, mut num_overstretched_edges) = (1.0f64, 0.0, 0, 0);
        for edge in mesh.edge_ids().filter(|&edge| !mesh.is_body(mesh.edge(edge)[0])) {
            let [a, b] = mesh.edge(edge).map(|vertex| weld.first(vertex) as usize);
            let length = distance(before[a], before[b]);
            if length <= 0.0 {
                continue;
            }
            let ratio = distance(after[a], after[b]) / length;
            // |log 0| is infinite, so that a collapsed edge is the worst of all.
            if ratio.ln().abs() > worst.ln().abs() {
                worst = ratio;
            }
            num_overstretched_edges += usize::from(ratio.ln().abs() > STRETCH_LIMIT.ln());
            ratios += ratio;
            count += 1;
        }
        let mean = |sum: f64, count: usize, without: f64| {
            #[expect(clippy::cast_precision_loss, reason = "numbers of elements are far below 2^52")]
            if count > 0 { sum / count as f64 } else { without }
        };
        Self {
            num_moved_vertices,
            max_displacement_m: largest,
            mean_displacement_m: mean(sum, num_vertices, 0.0),
            max_edge_stretch: worst,
            num_overstretched_edges,
            mean_edge_stretch: mean(ratios, count, 1.0),
        }
    }
}
