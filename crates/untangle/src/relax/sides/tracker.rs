//! Which free vertices are inside of a body, state by state.

use std::collections::BTreeSet;

use nalgebra::Point3;
use rayon::prelude::*;

use crate::{
    correspond::MaterialPoint,
    frame::Frame,
    mesh::{Mesh, VertexId},
    sides::{Sides, Way, cloth_vertices},
};

/// Vertices that one thread takes at a time, at least.
const MIN_VERTICES: usize = 64;

/// The bodies of a relaxation, which do not move, and what is known about the free vertices of the cloth.
#[derive(Debug)]
pub(crate) struct SideTracker {
    pub(super) sides: Sides,
    /// Pinned vertices of the cloth that are inside: nothing brings them out.
    pinned_inside: Vec<VertexId>,
    /// By vertex, ascending.
    pub(super) tracked: Vec<Tracked>,
    /// The mean length of the edges round each vertex in the input, over all tracked vertices, in metres.
    mean_edge_m: f64,
}

/// A free vertex of the cloth, and what was found where it was looked at.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tracked {
    pub(super) vertex: VertexId,
    /// The mean length of its edges in the input, in metres.
    pub(super) edge_m: f64,
    place: Point3<f64>,
    is_inside: bool,
    /// As far as the vertex moves no more than this, it stays on its side.
    clearance_m: f64,
}

impl SideTracker {
    /// The bodies of a mesh; nothing without any. `frame` is the input.
    ///
    /// Cost: O(n log n) in the mesh.
    pub(crate) fn of(mesh: &Mesh, frame: &Frame) -> Option<Self> {
        let sides = Sides::of(mesh, frame)?;
        let mean_edge_m = |vertex: VertexId| {
            let edges = mesh.vertex_edges(vertex);
            let lengths = edges.iter().map(|&edge| {
                let [a, b] = mesh.edge(edge).map(|end| frame.position(end));
                (b - a).norm()
            });
            #[expect(clippy::cast_precision_loss, reason = "a count of edges")]
            let count = edges.len().max(1) as f64;
            lengths.sum::<f64>() / count
        };
        let free = cloth_vertices(mesh).filter(|&vertex| !mesh.is_pinned(vertex));
        let tracked: Vec<Tracked> = free
            .map(|vertex| Tracked {
                vertex,
                edge_m: mean_edge_m(vertex),
                place: frame.position(vertex),
                is_inside: false,
                clearance_m: -1.0,
            })
            .collect();
        #[expect(clippy::cast_precision_loss, reason = "a count of vertices")]
        let count = tracked.len().max(1) as f64;
        let mean_edge_m = tracked.iter().map(|tracked| tracked.edge_m).sum::<f64>() / count;
        let pinned = cloth_vertices(mesh).filter(|&vertex| mesh.is_pinned(vertex));
        let pinned_inside = pinned.filter(|&vertex| sides.is_inside(frame.position(vertex))).collect();
        let mut tracker = Self { sides, pinned_inside, tracked, mean_edge_m };
        tracker.look(frame);
        Some(tracker)
    }

    /// Looks again at vertices that are far from where they were looked at. This changes no answer, only its cost.
    pub(crate) fn look(&mut self, frame: &Frame) {
        let Self { sides, tracked, .. } = self;
        tracked.par_iter_mut().with_min_len(MIN_VERTICES).for_each(|known| {
            let place = frame.position(known.vertex);
            let moved_m = (place - known.place).norm();
            if moved_m < 0.5 * known.clearance_m {
                return;
            }
            let is_inside = known.is_inside_at(sides, place);
            // Where a body is open the winding number fades away from its surface too.
            let clearance_m = if sides.are_closed() { sides.closest(place, is_inside).depth_m } else { 0.0 };
            *known = Tracked { place, is_inside, clearance_m, ..*known };
        });
    }

    /// Whether all that is left hangs on vertices that are pinned inside: free vertices that are joined with them inside,
    /// and intersections beside these. `crossing` are vertices of what intersects, one list for each intersection.
    pub(crate) fn hangs_on_pins(
        &self,
        mesh: &Mesh,
        positions: &[Point3<f64>],
        crossing: impl IntoIterator<Item = Vec<VertexId>>,
    ) -> bool {
        let wrong = self.wrong_vertices(positions);
        let mut reached: BTreeSet<VertexId> = self.pinned_inside.iter().copied().collect();
        let mut stack: Vec<VertexId> = self.pinned_inside.clone();
        let mut beside = reached.clone();
        while let Some(vertex) = stack.pop() {
            for &edge in mesh.vertex_edges(vertex) {
                let next = mesh.opposite_vertex(edge, vertex);
                beside.insert(next);
                if wrong.binary_search(&next).is_ok() && reached.insert(next) {
                    stack.push(next);
                }
            }
        }
        wrong.iter().all(|vertex| reached.contains(vertex))
            && crossing.into_iter().all(|vertices| vertices.iter().any(|vertex| beside.contains(vertex)))
    }

    /// The mean edge length of the cloth in the input, in metres.
    pub(crate) fn mean_edge_m(&self) -> f64 {
        self.mean_edge_m
    }

    /// The mean edge length at a point of the cloth in the input, in metres.
    pub(super) fn edge_m(&self, at: &MaterialPoint) -> f64 {
        let of_vertex = |vertex: &VertexId| {
            let index = self.tracked.binary_search_by_key(vertex, |known| known.vertex);
            index.map_or(self.mean_edge_m, |index| self.tracked[index].edge_m)
        };
        at.vertices.iter().zip(at.weights).map(|(vertex, weight)| weight * of_vertex(vertex)).sum()
    }

    /// The free vertices that are inside, ascending, each with the way out and the mean length of its edges in metres.
    ///
    /// Cost: a closest point for each of them, and a winding number for each vertex that may have changed its side.
    pub(crate) fn wrong(&self, positions: &[Point3<f64>]) -> Vec<(VertexId, Way, f64)> {
        let Self { sides, tracked, .. } = self;
        let wrong = tracked.par_iter().with_min_len(MIN_VERTICES).filter_map(|known| {
            let at = positions[known.vertex.index()];
            known.is_inside_at(sides, at).then(|| (known.vertex, sides.way_out(at), known.edge_m))
        });
        wrong.collect()
    }

    /// The free vertices that are inside, ascending.
    pub(crate) fn wrong_vertices(&self, positions: &[Point3<f64>]) -> Vec<VertexId> {
        let Self { sides, tracked, .. } = self;
        let is_inside = |known: &&Tracked| known.is_inside_at(sides, positions[known.vertex.index()]);
        tracked.par_iter().with_min_len(MIN_VERTICES).filter(is_inside).map(|known| known.vertex).collect()
    }
}

impl Tracked {
    /// Whether the vertex would be inside at a place.
    pub(super) fn is_inside_at(&self, sides: &Sides, at: Point3<f64>) -> bool {
        // A little less than the clearance, which is rounded.
        if (at - self.place).norm() < (1.0 - 1e-9) * self.clearance_m { self.is_inside } else { sides.is_inside(at) }
    }

    /// A lower bound of the distance to the surface, in metres.
    pub(super) fn distance_m(&self, at: Point3<f64>) -> f64 {
        self.clearance_m - (at - self.place).norm()
    }
}
