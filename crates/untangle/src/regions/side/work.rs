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
    regions::{
        flood::{FillRules, Flood},
        view::FrameView,
    },
    sparse_map::SparseMap,
};

/// A vertex in the queue, with a point of the path that may be its nearest one; the smallest distance comes first.
#[derive(Debug)]
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

/// Searches for the work of both sides, reusing its memory.
#[derive(Debug, Default)]
pub(super) struct WorkSearch {
    is_settled: SparseMap<VertexId, ()>,
    queue: BinaryHeap<Reached>,
}

impl WorkSearch {
    /// The side with less work, after a fill that separated; nothing where both take the same.
    ///
    /// The side that the fill completed is searched whole, the other one only until it takes more work: there is no
    /// need to know more of it, and mostly it is the rest of the piece. Cost: O(n log n) in the vertices that are
    /// reached.
    pub(super) fn cheaper_side(
        &mut self,
        flood: &mut Flood,
        view: &FrameView<'_>,
        points: &[PathPoint],
        rules: &FillRules<'_>,
    ) -> Option<usize> {
        // Where the path crosses an edge of the larger side twice, the fill need not have come to that edge.
        let edges = points.iter().filter_map(|point| match point.own {
            SurfacePoint::Edge { edge, .. } => Some(edge),
            _ => None,
        });
        flood.reach(view.mesh, rules, edges.flat_map(|edge| view.mesh.edge(edge)));
        let first = flood.smaller();
        let known = self.work(flood, view, points, rules, (first, f64::INFINITY));
        let other = self.work(flood, view, points, rules, (1 - first, known));
        if known < other {
            Some(first)
        } else if other < known {
            Some(1 - first)
        } else {
            None
        }
    }

    /// The work of a side, or a part of it that is more than `enough`.
    ///
    /// A Dijkstra search from the crossed edges outwards, in which each vertex hands the point of the path that is
    /// nearest to it on to its neighbours.
    fn work(
        &mut self,
        flood: &Flood,
        view: &FrameView<'_>,
        points: &[PathPoint],
        rules: &FillRules<'_>,
        (side, enough): (usize, f64),
    ) -> f64 {
        let Self { is_settled, queue } = self;
        is_settled.reset(view.mesh.num_vertices());
        queue.clear();
        let reach = |vertex: VertexId, from: Point3<f64>| {
            let distance = (view.frame.position(vertex) - from).norm();
            Reached { distance, vertex, from }
        };
        for point in points {
            let SurfacePoint::Edge { edge, .. } = point.own else { continue };
            let ends = view.mesh.edge(edge).into_iter().filter(|&end| flood.side_of(end) == Some(side));
            queue.extend(ends.map(|end| reach(end, point.position)));
        }
        let mut work = 0.0;
        while let Some(Reached { distance, vertex, from }) = queue.pop() {
            if !is_settled.insert(vertex, ()) {
                continue;
            }
            work += view.vertex_area(vertex) * distance * distance;
            if work > enough {
                break;
            }
            for &edge in view.mesh.vertex_edges(vertex) {
                let neighbour = view.mesh.opposite_vertex(edge, vertex);
                if !is_settled.contains(neighbour) && flood.leads_to_same_side(edge, neighbour, rules) {
                    queue.push(reach(neighbour, from));
                }
            }
        }
        work
    }
}
