//! Geodesic distance of vertices from the boundary, by fast marching no farther than somebody asks.

use std::{cmp::Ordering, collections::BinaryHeap};

use crate::{
    frame::Frame,
    mesh::{Mesh, VertexId},
    sparse_map::SparseMap,
};

/// Distances along the surface from all boundaries of a mesh, by fast marching (Kimmel and Sethian 1998). The front
/// stops at the distance asked for and continues from there when a larger one is asked for: all paths of a frame share
/// it.
#[derive(Debug, Default)]
pub(crate) struct BoundaryDistance {
    arrivals: SparseMap<VertexId, Arrival>,
    /// The trial vertices of the front; a vertex whose distance shrank stands here several times.
    front: BinaryHeap<TrialVertex>,
    is_started: bool,
}

/// When the front arrives at a vertex.
#[derive(Clone, Copy, Debug)]
struct Arrival {
    distance_m: f64,
    is_final: bool,
}

impl Default for Arrival {
    fn default() -> Self {
        Self { distance_m: f64::INFINITY, is_final: false }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct TrialVertex {
    distance_m: f64,
    vertex: VertexId,
}

impl Eq for TrialVertex {}

impl Ord for TrialVertex {
    fn cmp(&self, other: &Self) -> Ordering {
        // Reversed, since the heap gives the greatest: the nearest first, then the lowest vertex.
        other.distance_m.total_cmp(&self.distance_m).then(other.vertex.cmp(&self.vertex))
    }
}

impl PartialOrd for TrialVertex {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl BoundaryDistance {
    /// Makes ready for another frame.
    pub(crate) fn reset(&mut self) {
        self.front.clear();
        self.is_started = false;
    }

    /// The distance of a vertex from the nearest boundary along the surface, in metres; nothing where it is more than
    /// `farthest_m`.
    ///
    /// Cost: over all calls for one frame O(n log n) in the vertices that are no farther from a boundary than the
    /// farthest one asked for; with the first, linear in the vertices of the mesh.
    pub(crate) fn distance_m(&mut self, mesh: &Mesh, frame: &Frame, vertex: VertexId, farthest_m: f64) -> Option<f64> {
        if !self.is_started {
            self.start(mesh);
        }
        while !self.arrival(vertex).is_final && self.front.peek().is_some_and(|next| next.distance_m <= farthest_m) {
            self.advance(mesh, frame);
        }
        let Arrival { distance_m, is_final } = self.arrival(vertex);
        is_final.then_some(distance_m).filter(|&distance_m| distance_m <= farthest_m)
    }

    fn arrival(&self, vertex: VertexId) -> Arrival {
        self.arrivals.get(vertex).unwrap_or_default()
    }

    fn start(&mut self, mesh: &Mesh) {
        self.is_started = true;
        self.arrivals.reset(mesh.num_vertices());
        for vertex in mesh.vertex_ids().filter(|&vertex| mesh.is_boundary_vertex(vertex)) {
            self.offer(vertex, 0.0);
        }
    }

    /// Takes a distance for a vertex if it is shorter than the one so far.
    fn offer(&mut self, vertex: VertexId, distance_m: f64) {
        let arrival = self.arrivals.entry(vertex);
        if distance_m < arrival.distance_m {
            arrival.distance_m = distance_m;
            self.front.push(TrialVertex { distance_m, vertex });
        }
    }

    /// Makes the nearest trial vertex final, and offers distances to its neighbours.
    fn advance(&mut self, mesh: &Mesh, frame: &Frame) {
        let Some(TrialVertex { vertex, .. }) = self.front.pop() else { return };
        if std::mem::replace(&mut self.arrivals.entry(vertex).is_final, true) {
            return;
        }
        for &face in mesh.vertex_faces(vertex) {
            let corners = mesh.face(face);
            for k in 0..3 {
                let (target, others) = (corners[k], [corners[(k + 1) % 3], corners[(k + 2) % 3]]);
                if !self.arrival(target).is_final {
                    let distance_m = self.update(mesh, frame, target, others);
                    self.offer(target, distance_m);
                }
            }
        }
    }

    /// The distance of a vertex through the triangle with two others: that of a straight front where it enters between
    /// them, or else that along a side.
    fn update(&self, mesh: &Mesh, frame: &Frame, target: VertexId, others: [VertexId; 2]) -> f64 {
        let known = others.map(|vertex| match self.arrival(vertex) {
            Arrival { distance_m, is_final: true } => distance_m,
            Arrival { .. } => f64::INFINITY,
        });
        let sides = others.map(|vertex| frame.position(vertex) - frame.position(target));
        let along_sides = (known[0] + sides[0].norm()).min(known[1] + sides[1].norm());
        if !(known[0].is_finite() && known[1].is_finite()) {
            return along_sides;
        }
        // An inner edge between two boundary vertices cuts a corner off: the front does not start on it.
        if known.iter().all(|&distance| distance <= 0.0) && !is_boundary_edge(mesh, others) {
            return along_sides;
        }
        // The front is the plane wave with slope 1 through both values: |Q^-1 (values - d)| = 1 in the frame of the two
        // sides.
        let (aa, ab, bb) = (sides[0].norm_squared(), sides[0].dot(&sides[1]), sides[1].norm_squared());
        let determinant = aa * bb - ab * ab;
        if determinant <= 1e-12 * aa * bb {
            return along_sides;
        }
        let inverse = |x: [f64; 2], y: [f64; 2]| {
            (bb * x[0] * y[0] - ab * (x[0] * y[1] + x[1] * y[0]) + aa * x[1] * y[1]) / determinant
        };
        let (ones, values) = ([1.0; 2], known);
        let (p, q, r) = (inverse(ones, ones), inverse(ones, values), inverse(values, values) - 1.0);
        let root = q * q - p * r;
        if root < 0.0 || p <= 0.0 {
            return along_sides;
        }
        let distance = (q + root.sqrt()) / p;
        let slack = [distance - known[0], distance - known[1]];
        // The direction against the front, in the frame of the sides, must point between them.
        let enters = [bb * slack[0] - ab * slack[1], aa * slack[1] - ab * slack[0]];
        if enters.iter().all(|&part| part >= 0.0) { distance.min(along_sides) } else { along_sides }
    }
}

fn is_boundary_edge(mesh: &Mesh, [a, b]: [VertexId; 2]) -> bool {
    mesh.edge_between(a, b).is_some_and(|edge| mesh.is_boundary_edge(edge))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::correspond::samples;

    /// A sheet of 10 x 12 squares of 0.1 m.
    fn sheet() -> (Mesh, Frame, Vec<[f64; 3]>) {
        let (mesh, flat) = samples::sheet(10, 12, 0.1);
        let positions: Vec<_> = flat.iter().map(|point| [point.x, point.y, 0.0]).collect();
        let frame = Frame::new(&mesh, &positions).unwrap();
        (mesh, frame, positions)
    }

    #[test]
    fn boundary_distance_on_sheet_is_that_to_the_nearest_side() {
        let (mesh, frame, positions) = sheet();
        let mut distance = BoundaryDistance::default();
        for (vertex, [x, y, _]) in mesh.vertex_ids().zip(positions) {
            let expected = x.min(1.0 - x).min(y).min(1.2 - y);
            let found = distance.distance_m(&mesh, &frame, vertex, 9.0).unwrap();
            // Where two fronts meet, the distance comes out too short by a part of an edge; nowhere is it too long.
            assert!(found < expected + 1e-9 && found > expected - 0.05, "{vertex:?}: {found} {expected}");
        }
    }

    #[test]
    fn boundary_distance_asked_in_parts_is_that_asked_at_once() {
        let (mesh, frame, _) = sheet();
        let mut all = BoundaryDistance::default();
        let expected: Vec<f64> =
            mesh.vertex_ids().map(|vertex| all.distance_m(&mesh, &frame, vertex, 9.0).unwrap()).collect();
        let mut distance = BoundaryDistance::default();
        for _ in 0..2 {
            let middle = VertexId(6 * 11 + 5);
            assert_eq!(distance.distance_m(&mesh, &frame, VertexId(2 * 11 + 1), 9.0), Some(expected[2 * 11 + 1]));
            assert!(!distance.arrival(middle).is_final);
            assert_eq!(distance.distance_m(&mesh, &frame, middle, 0.2), None);
            for (vertex, &expected) in mesh.vertex_ids().zip(&expected) {
                let found = distance.distance_m(&mesh, &frame, vertex, 9.0);
                assert_eq!(found.map(f64::to_bits), Some(expected.to_bits()));
                // What is known already is still too far for some.
                assert_eq!(distance.distance_m(&mesh, &frame, vertex, 0.2).is_some(), expected <= 0.2);
            }
            distance.reset();
        }
    }
}
