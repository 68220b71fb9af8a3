//! Pairs that can't be set apart.

use crate::{
    frame::Frame,
    mesh::{Mesh, VertexId},
    proximity::{Primitives, SurfaceWays, closest_points},
};

use super::outcome::ClearanceObstacle;

/// Finds out what keeps pairs from being set apart, with its memory. Lengths are those of the rest shape.
#[derive(Debug, Default)]
pub(super) struct Obstacles {
    ways: SurfaceWays,
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
        let closest = closest_points(mesh, frame, primitives);
        self.ways.join_within(mesh, rest, &closest, distance_m).then_some(ClearanceObstacle::Surface)
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
