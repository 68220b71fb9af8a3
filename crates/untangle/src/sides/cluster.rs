//! Vertices on the wrong side that edges join.

use super::WrongSide;
use crate::mesh::{Mesh, VertexId};

/// Vertices inside of a body that edges join, as one place that could not be resolved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WrongCluster {
    /// The deepest of them.
    pub vertex: VertexId,
    /// How many there are.
    pub num_vertices: usize,
    /// How many of them are pinned.
    pub num_pinned: usize,
    /// The largest depth in metres.
    pub depth_m: f64,
}

/// The clusters of vertices on the wrong side, `wrong` by vertex, ascending; in the order of their lowest vertices.
///
/// Cost: O(n log n) in the vertices.
#[must_use]
pub fn clusters(mesh: &Mesh, wrong: &[WrongSide]) -> Vec<WrongCluster> {
    let mut is_reached = vec![false; wrong.len()];
    let mut clusters = Vec::new();
    let mut stack = Vec::new();
    for (first, WrongSide { vertex, .. }) in wrong.iter().enumerate() {
        if std::mem::replace(&mut is_reached[first], true) {
            continue;
        }
        stack.push(first);
        let mut cluster = WrongCluster { vertex: *vertex, num_vertices: 0, num_pinned: 0, depth_m: 0.0 };
        while let Some(index) = stack.pop() {
            let WrongSide { vertex, way } = wrong[index];
            cluster.num_vertices += 1;
            cluster.num_pinned += usize::from(mesh.is_pinned(vertex));
            if way.depth_m > cluster.depth_m {
                (cluster.vertex, cluster.depth_m) = (vertex, way.depth_m);
            }
            for &edge in mesh.vertex_edges(vertex) {
                let next = mesh.opposite_vertex(edge, vertex);
                if let Ok(next) = wrong.binary_search_by_key(&next, |wrong| wrong.vertex)
                    && !std::mem::replace(&mut is_reached[next], true)
                {
                    stack.push(next);
                }
            }
        }
        clusters.push(cluster);
    }
    clusters
}
