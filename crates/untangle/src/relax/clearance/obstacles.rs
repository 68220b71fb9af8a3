//! Pairs that can't be set apart.

use crate::{
    frame::Frame,
    geodesic::GeodesicFront,
    mesh::{Mesh, VertexId},
    proximity::{Primitives, closest_points},
};

use super::outcome::ClearanceObstacle;

/// Weights up to this are none: the closest point lies in the rest of its primitive.
const NO_WEIGHT: f64 = 1e-9;

/// Finds out what keeps pairs from being set apart, with its memory. Lengths are those of the rest shape.
#[derive(Debug, Default)]
pub(super) struct Obstacles {
    front: GeodesicFront,
}

impl Obstacles {
    /// The obstacle that can be told before any motion: pins, and the surface itself. `rest` holds the rest shape,
    /// `frame` the present state.
    ///
    /// Cost: linear in the vertices within the distance along the surface.
    pub(super) fn find(
        &mut self,
        mesh: &Mesh,
        [rest, frame]: [&Frame; 2],
        primitives: Primitives,
        distance_m: f64,
    ) -> Option<ClearanceObstacle> {
        if primitives.vertices(mesh).all(|vertex| mesh.is_pinned(vertex)) {
            return Some(ClearanceObstacle::Pinned);
        }
        self.is_connected_within(mesh, [rest, frame], primitives, distance_m).then_some(ClearanceObstacle::Surface)
    }

    /// Whether a way along the surface joins the closest points that is shorter at rest than a distance.
    fn is_connected_within(
        &mut self,
        mesh: &Mesh,
        [rest, frame]: [&Frame; 2],
        primitives: Primitives,
        distance_m: f64,
    ) -> bool {
        let closest = closest_points(mesh, frame, primitives);
        let support = |side: usize| {
            let weighted = closest.vertices[side].into_iter().zip(closest.weights[side]);
            weighted.filter(|(_, weight)| *weight > NO_WEIGHT).map(|(vertex, _)| vertex)
        };
        let place = |side: usize| {
            let weighted = closest.vertices[side].into_iter().zip(closest.weights[side]);
            weighted.map(|(vertex, weight)| rest.position(vertex).coords * weight).sum::<nalgebra::Vector3<f64>>()
        };
        let places = [place(0), place(1)];
        if let Some(start) = support(0).next() {
            // Two points of one face: the way is straight.
            let has_both =
                |corners: [VertexId; 3]| [0, 1].into_iter().all(|side| support(side).all(|v| corners.contains(&v)));
            if mesh.vertex_faces(start).iter().any(|&face| has_both(mesh.face(face))) {
                return (places[0] - places[1]).norm() < distance_m;
            }
        }
        let to_place = |side: usize, vertex: VertexId| (rest.position(vertex).coords - places[side]).norm();
        self.front.reset(mesh.num_vertices());
        for vertex in support(0) {
            self.front.offer(vertex, to_place(0, vertex));
        }
        while self.front.next().is_some_and(|next| next < distance_m) {
            self.front.advance(mesh, rest, |_| true);
        }
        support(1)
            .any(|vertex| self.front.passed(vertex).is_some_and(|passed| passed + to_place(1, vertex) < distance_m))
    }
}

/// Why a pair that no step set further apart is held.
pub(super) fn held(mesh: &Mesh, primitives: Primitives) -> ClearanceObstacle {
    let is_near_pin = |vertex: VertexId| {
        mesh.is_pinned(vertex)
            || mesh.vertex_edges(vertex).iter().any(|&edge| mesh.is_pinned(mesh.opposite_vertex(edge, vertex)))
    };
    if primitives.vertices(mesh).any(is_near_pin) { ClearanceObstacle::PartlyPinned } else { ClearanceObstacle::Held }
}
