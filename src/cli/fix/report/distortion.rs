//! How much a repair changed the cloth.

use nalgebra::Point3;
use serde::Serialize;

use untangle::mesh::Mesh;

/// Distances and ratios between two states of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Distortion {
    /// Largest way of a vertex, in metres.
    pub max_displacement_m: f64,
    /// Mean way of all vertices, in metres.
    pub mean_displacement_m: f64,
    /// Length after by length before of the edge with the largest |log| of it; 0 for an edge that is a point now.
    pub max_edge_stretch: f64,
    /// Mean of that ratio.
    pub mean_edge_stretch: f64,
}

impl Distortion {
    /// Compares two states. Edges that had no length before have no ratio and are left out; without any edge the ratios are 1.
    pub(super) fn new(mesh: &Mesh, before: &[[f64; 3]], after: &[[f64; 3]]) -> Self {
        let distance = |a: [f64; 3], b: [f64; 3]| nalgebra::distance(&Point3::from(a), &Point3::from(b));
        let (mut longest, mut sum) = (0.0f64, 0.0);
        for (&before, &after) in before.iter().zip(after) {
            let way = distance(before, after);
            longest = longest.max(way);
            sum += way;
        }
        let (mut worst, mut ratios, mut count) = (1.0f64, 0.0, 0);
        for edge in mesh.edge_ids() {
            let [a, b] = mesh.edge(edge).map(|vertex| vertex.0 as usize);
            let length = distance(before[a], before[b]);
            if length <= 0.0 {
                continue;
            }
            let ratio = distance(after[a], after[b]) / length;
            // |log 0| is infinite, which is what an edge that has become a point deserves.
            if ratio.ln().abs() > worst.ln().abs() {
                worst = ratio;
            }
            ratios += ratio;
            count += 1;
        }
        let mean = |sum: f64, count: usize, without: f64| {
            #[expect(clippy::cast_precision_loss, reason = "numbers of elements are far below 2^52")]
            if count > 0 { sum / count as f64 } else { without }
        };
        Self {
            max_displacement_m: longest,
            mean_displacement_m: mean(sum, before.len(), 0.0),
            max_edge_stretch: worst,
            mean_edge_stretch: mean(ratios, count, 1.0),
        }
    }
}
