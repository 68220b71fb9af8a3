//! Which free vertices are on the wrong side, state by state.

use std::collections::BTreeSet;

use nalgebra::Point3;
use rayon::prelude::*;

use crate::{
    correspond::MaterialPoint,
    frame::Frame,
    mesh::{FaceId, Mesh, VertexId},
    sides::{LayerState, Layers, Sides, Way, WrongSide, cloth_vertices},
};

/// Vertices that one thread takes at a time, at least.
const MIN_VERTICES: usize = 64;

/// The bodies of a relaxation, which do not move, its layers, and what is known about the free vertices of the cloth.
#[derive(Debug)]
pub(crate) struct SideTracker {
    pub(super) bodies: Option<Sides>,
    pub(super) layers: Option<Layers>,
    /// Pinned vertices of the cloth that are inside: nothing brings them out.
    pinned_inside: Vec<VertexId>,
    /// By vertex, ascending.
    pub(super) tracked: Vec<Tracked>,
    /// The mean length of the edges round each vertex in the input, over all tracked vertices, in metres.
    mean_edge_m: f64,
}

/// A vertex on the wrong side.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wrong {
    pub(crate) vertex: VertexId,
    /// The way to the right side.
    pub(crate) way: Way,
    /// The mean length of the vertex' edges in the input, in metres.
    pub(crate) edge_m: f64,
}

/// A free vertex of the cloth, and what was found where it was looked at.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tracked {
    pub(super) vertex: VertexId,
    /// The mean length of its edges in the input, in metres.
    pub(super) edge_m: f64,
    place: Point3<f64>,
    is_inside: bool,
    /// As far as the vertex moves no more than this, it stays on its side of the bodies.
    clearance_m: f64,
}

impl SideTracker {
    /// The bodies and layers of a mesh; nothing without any. `frame` is the input.
    ///
    /// Cost: O(n log n) in the mesh.
    pub(crate) fn of(mesh: &Mesh, frame: &Frame) -> Option<Self> {
        let bodies = Sides::of(mesh, frame);
        let layers = Layers::of(mesh, frame, bodies.as_ref());
        if bodies.is_none() && layers.is_none() {
            return None;
        }
        let free = cloth_vertices(mesh).filter(|&vertex| !mesh.is_pinned(vertex));
        let tracked: Vec<Tracked> = free
            .map(|vertex| Tracked {
                vertex,
                edge_m: mean_edge_m(mesh, frame, vertex),
                place: frame.position(vertex),
                is_inside: false,
                clearance_m: -1.0,
            })
            .collect();
        #[expect(clippy::cast_precision_loss, reason = "a count of vertices")]
        let count = tracked.len().max(1) as f64;
        let mean_edge_m = tracked.iter().map(|tracked| tracked.edge_m).sum::<f64>() / count;
        let is_inside = |vertex: &VertexId| bodies.as_ref().is_some_and(|body| body.is_inside(frame.position(*vertex)));
        let pinned = cloth_vertices(mesh).filter(|&vertex| mesh.is_pinned(vertex));
        let pinned_inside = pinned.filter(is_inside).collect();
        let mut tracker = Self { bodies, layers, pinned_inside, tracked, mean_edge_m };
        tracker.look(frame);
        Some(tracker)
    }

    /// Looks again at vertices that are far from where they were looked at. This changes no answer, only its cost.
    pub(crate) fn look(&mut self, frame: &Frame) {
        let Self { bodies: Some(bodies), tracked, .. } = self else { return };
        tracked.par_iter_mut().with_min_len(MIN_VERTICES).for_each(|known| {
            let place = frame.position(known.vertex);
            let moved_m = (place - known.place).norm();
            if moved_m < 0.5 * known.clearance_m {
                return;
            }
            let is_inside = known.is_inside_at(bodies, place);
            // Where a body is open the winding number fades away from its surface too.
            let clearance_m = if bodies.are_closed() { bodies.closest(place, is_inside).depth_m } else { 0.0 };
            *known = Tracked { place, is_inside, clearance_m, ..*known };
        });
    }

    /// Whether bodies or layers say on which side of each other two faces belong.
    pub(crate) fn decides(&self, mesh: &Mesh, faces: [FaceId; 2]) -> bool {
        let number = |face: FaceId| mesh.layers().map(|numbers| numbers[mesh.face(face)[0].index()]);
        faces.iter().any(|&face| mesh.is_body_face(face))
            || self.layers.is_some() && number(faces[0]) != number(faces[1])
    }

    /// The mean edge length at a point of the cloth in the input, in metres.
    pub(super) fn edge_m(&self, at: &MaterialPoint) -> f64 {
        at.vertices.iter().zip(at.weights).map(|(vertex, weight)| weight * self.edge_m_at(*vertex)).sum()
    }

    fn edge_m_at(&self, vertex: VertexId) -> f64 {
        let index = self.tracked.binary_search_by_key(&vertex, |known| known.vertex);
        index.map_or(self.mean_edge_m, |index| self.tracked[index].edge_m)
    }

    /// The mean edge length of the cloth in the input, in metres.
    pub(crate) fn mean_edge_m(&self) -> f64 {
        self.mean_edge_m
    }

    /// What is on the wrong side, as far as a motion can change that: free vertices inside of bodies, ascending, then
    /// vertices behind layers, ascending.
    ///
    /// Cost: a closest point for each of them, and a winding number for each vertex that may have changed its side;
    /// O(n log n) in the faces of layers.
    pub(crate) fn wrong(&self, mesh: &Mesh, positions: &[Point3<f64>]) -> Vec<Wrong> {
        let Self { bodies, layers, tracked, .. } = self;
        let mut wrong: Vec<Wrong> = Vec::new();
        if let Some(bodies) = bodies {
            let inside = tracked.par_iter().with_min_len(MIN_VERTICES).filter_map(|known| {
                let at = positions[known.vertex.index()];
                let Tracked { vertex, edge_m, .. } = *known;
                known.is_inside_at(bodies, at).then(|| Wrong { vertex, way: bodies.way_out(at), edge_m })
            });
            wrong.par_extend(inside);
        }
        if let Some(layers) = layers {
            let is_movable = |vertex: VertexId, way: &Way| {
                !mesh.is_pinned(vertex) || mesh.face(way.face).into_iter().any(|corner| !mesh.is_pinned(corner))
            };
            let behind = layers.behind(mesh, positions).into_iter();
            let behind = behind.filter(|WrongSide { vertex, way }| is_movable(*vertex, way));
            wrong.extend(behind.map(|WrongSide { vertex, way }| {
                let edge_m = self.edge_m_at(vertex);
                Wrong { vertex, way, edge_m }
            }));
        }
        wrong
    }

    /// The free vertices on the wrong side, ascending.
    pub(crate) fn wrong_vertices(&self, mesh: &Mesh, positions: &[Point3<f64>]) -> Vec<VertexId> {
        let mut vertices: Vec<VertexId> = self.wrong(mesh, positions).iter().map(|wrong| wrong.vertex).collect();
        vertices.sort_unstable();
        vertices.dedup();
        vertices
    }

    /// The free vertices on the wrong side, each with the corners of the face of the layer that it is behind.
    pub(crate) fn wrong_groups(&self, mesh: &Mesh, positions: &[Point3<f64>]) -> Vec<Vec<VertexId>> {
        let group = |Wrong { vertex, way, .. }: &Wrong| {
            let is_fixed = mesh.is_body_face(way.face);
            let corners = mesh.face(way.face).into_iter().filter(|_| !is_fixed);
            std::iter::once(*vertex).chain(corners).collect()
        };
        self.wrong(mesh, positions).iter().map(group).collect()
    }

    /// Layers at one instant, if there are any.
    pub(super) fn layer_state<'a>(&'a self, mesh: &'a Mesh, positions: &'a [Point3<f64>]) -> Option<LayerState<'a>> {
        self.layers.as_ref().map(|layers| LayerState::of(layers, mesh, positions))
    }

    /// Whether all that is left hangs on vertices that are pinned inside: free vertices that are joined with them
    /// inside, and intersections beside these. `crossing` are vertices of what intersects, one list for each.
    pub(crate) fn hangs_on_pins(
        &self,
        mesh: &Mesh,
        positions: &[Point3<f64>],
        crossing: impl IntoIterator<Item = Vec<VertexId>>,
    ) -> bool {
        let wrong = self.wrong_vertices(mesh, positions);
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
}

impl Tracked {
    /// Whether the vertex would be inside of a body at a place.
    pub(super) fn is_inside_at(&self, bodies: &Sides, at: Point3<f64>) -> bool {
        // A little less than the clearance, which is rounded.
        if (at - self.place).norm() < (1.0 - 1e-9) * self.clearance_m { self.is_inside } else { bodies.is_inside(at) }
    }

    /// A lower bound of the distance to the bodies, in metres.
    pub(super) fn distance_m(&self, at: Point3<f64>) -> f64 {
        self.clearance_m - (at - self.place).norm()
    }
}

/// The mean length of the edges of a vertex, in metres.
fn mean_edge_m(mesh: &Mesh, frame: &Frame, vertex: VertexId) -> f64 {
    let edges = mesh.vertex_edges(vertex);
    let lengths = edges.iter().map(|&edge| {
        let [a, b] = mesh.edge(edge).map(|end| frame.position(end));
        (b - a).norm()
    });
    #[expect(clippy::cast_precision_loss, reason = "a count of edges")]
    let count = edges.len().max(1) as f64;
    lengths.sum::<f64>() / count
}
