mod chart;
mod locate;
mod patch;
mod rbf;
mod relax;
#[cfg(test)]
mod samples;
mod shapes;
mod unfold;

use crate::mesh::VertexId;

/// A point of the cloth that moves with it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaterialPoint {
    /// Vertices of its face; the first alone counts for a point in a vertex.
    pub vertices: [VertexId; 3],
    /// Weight of each; they sum to 1.
    pub weights: [f64; 3],
}
