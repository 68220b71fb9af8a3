//! Which primitives are joined along the surface: how near they are is a matter of shape, not of contact.

use nalgebra::Vector3;

use super::pair::ClosestPoints;
use crate::{
    frame::Frame,
    geodesic::GeodesicFront,
    mesh::{Mesh, VertexId},
};

/// Weights up to this are none: the closest point lies in the rest of its primitive.
const NO_WEIGHT: f64 = 1e-9;

/// Ways along the surface, with the memory to find them.
#[derive(Debug, Default)]
pub(crate) struct SurfaceWays {
    front: GeodesicFront,
}

impl SurfaceWays {
    /// Whether a way along the surface joins the closest points of a pair that is shorter at rest than a distance in
    /// metres: one through a vertex of each primitive, so that none is called shorter than it is. `rest` holds the rest
    /// shape.
    ///
    /// Cost: O(n log n) in the vertices within the distance along the surface.
    pub(crate) fn join_within(&mut self, mesh: &Mesh, rest: &Frame, closest: &ClosestPoints, distance_m: f64) -> bool {
        let [own, partner] = supports(rest, closest);
        own.shares_face_within(mesh, &partner, distance_m).unwrap_or_else(|| {
            self.march(mesh, rest, &own, distance_m);
            partner.vertices().any(|(vertex, way_m)| self.passed(vertex).is_some_and(|way| way + way_m < distance_m))
        })
    }

    /// Whether such a way may be shorter than a distance: where it can't, none is, whatever it goes through.
    ///
    /// Cost: as above, with the vertices that are an edge farther; nothing where the two lie in different pieces, or
    /// farther from each other at rest.
    pub(crate) fn may_join_within(
        &mut self,
        mesh: &Mesh,
        rest: &Frame,
        closest: &ClosestPoints,
        distance_m: f64,
    ) -> bool {
        let [own, partner] = supports(rest, closest);
        let piece =
            |support: &Support| mesh.vertex_faces(support.vertices[0]).first().and_then(|&face| mesh.piece(face));
        if piece(&own) != piece(&partner) || (own.place - partner.place).norm() >= distance_m {
            return false;
        }
        own.shares_face_within(mesh, &partner, distance_m).unwrap_or_else(|| {
            let farthest_m = partner.vertices().map(|(_, way_m)| way_m).fold(0.0, f64::max);
            self.march(mesh, rest, &own, distance_m + farthest_m);
            partner.vertices().any(|(vertex, way_m)| self.passed(vertex).is_some_and(|way| way - way_m < distance_m))
        })
    }

    /// Lets a front go so far from a point.
    fn march(&mut self, mesh: &Mesh, rest: &Frame, from: &Support, distance_m: f64) {
        self.front.reset(mesh.num_vertices());
        for (vertex, way_m) in from.vertices() {
            self.front.offer(vertex, way_m);
        }
        while self.front.next().is_some_and(|next| next < distance_m) {
            self.front.advance(mesh, rest, |_| true);
        }
    }

    fn passed(&self, vertex: VertexId) -> Option<f64> {
        self.front.passed(vertex)
    }
}

/// A point of a primitive: the vertices between which it lies, and where it is at rest.
#[derive(Clone, Copy, Debug)]
struct Support {
    vertices: [VertexId; 3],
    weights: [f64; 3],
    place: Vector3<f64>,
    /// From each vertex to the point, straight.
    ways_m: [f64; 3],
}

/// The closest points of a pair.
fn supports(rest: &Frame, closest: &ClosestPoints) -> [Support; 2] {
    [0, 1].map(|side| {
        let (vertices, weights) = (closest.vertices[side], closest.weights[side]);
        let weighted = vertices.into_iter().zip(weights);
        let place = weighted.map(|(vertex, weight)| rest.position(vertex).coords * weight).sum::<Vector3<f64>>();
        let ways_m = vertices.map(|vertex| (rest.position(vertex).coords - place).norm());
        Support { vertices, weights, place, ways_m }
    })
}

impl Support {
    /// The vertices between which it lies, and how far each is.
    fn vertices(&self) -> impl Iterator<Item = (VertexId, f64)> + use<> {
        let Self { vertices, weights, ways_m, .. } = *self;
        (0..3).filter(move |&at| weights[at] > NO_WEIGHT).map(move |at| (vertices[at], ways_m[at]))
    }

    /// Whether another point is nearer than a distance, if both lie in one face: the way is straight then.
    fn shares_face_within(&self, mesh: &Mesh, other: &Self, distance_m: f64) -> Option<bool> {
        let (start, _) = self.vertices().next()?;
        let has_both = |corners: [VertexId; 3]| {
            self.vertices().chain(other.vertices()).all(|(vertex, _)| corners.contains(&vertex))
        };
        let is_shared = mesh.vertex_faces(start).iter().any(|&face| has_both(mesh.face(face)));
        is_shared.then(|| (self.place - other.place).norm() < distance_m)
    }
}
