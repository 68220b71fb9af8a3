//! The side of a path that takes less work to bring back.
//!
//! The work of a correction is the sum over the vertices of area times squared distance from the target (Wicke, Lanker
//! and Gross 2006 ask for the smallest possible correction). Targets are computed only later, and only for the chosen
//! side; the distance from the path stands in for them: it is zero on the path for both, and grows with the depth of
//! the penetration.

use std::{cmp::Ordering, collections::BinaryHeap};

use nalgebra::Point3;

use crate::{
    mesh::VertexId,
    paths::{PathPoint, SurfacePoint},
    regions::{flood::Flood, view::FrameView},
};

/// A vertex in the queue, with a point of the path that may be its nearest one; the smallest distance comes first.
struct Reached {
    distance: f64,
    vertex: VertexId,
    from: Point3<f64>,
}

impl Ord for Reached {
    fn cmp(&self, other: &Self) -> Ordering {
        // Reversed, since the heap gives the greatest: the nearest first, then the lowest vertex.
        other.distance.total_cmp(&self.distance).then(other.vertex.cmp(&self.vertex))
    }
}

impl PartialOrd for Reached {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Reached {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Reached {}

/// The side with less work, after a fill that is complete on both sides; nothing where both take the same.
///
/// A Dijkstra search from the crossed edges outwards, in which each vertex hands the point of the path that is nearest
/// to it on to its neighbours. Cost: O(n log n) in the piece.
pub(crate) fn by_work(flood: &Flood, view: &FrameView<'_>, points: &[PathPoint]) -> Option<usize> {
    let mut is_settled = vec![false; view.mesh.num_vertices()];
    let mut queue = BinaryHeap::new();
    let reach = |vertex: VertexId, from: Point3<f64>| {
        let distance = (view.frame.position(vertex) - from).norm();
        Reached { distance, vertex, from }
    };
    for point in points {
        let SurfacePoint::Edge { edge, .. } = point.own else { continue };
        let ends = view.mesh.edge(edge).into_iter().filter(|&end| flood.side_of(end).is_some());
        queue.extend(ends.map(|end| reach(end, point.position)));
    }
    let mut work = [0.0; 2];
    while let Some(Reached { distance, vertex, from }) = queue.pop() {
        let Some(side) = flood.side_of(vertex) else { continue };
        if std::mem::replace(&mut is_settled[vertex.index()], true) {
            continue;
        }
        work[side] += view.vertex_area(vertex) * distance * distance;
        for &edge in view.mesh.vertex_edges(vertex) {
            let neighbour = view.mesh.opposite_vertex(edge, vertex);
            if flood.side_of(neighbour) == Some(side) && !is_settled[neighbour.index()] {
                queue.push(reach(neighbour, from));
            }
        }
    }
    if work[0] < work[1] {
        Some(0)
    } else if work[1] < work[0] {
        Some(1)
    } else {
        None
    }
}
