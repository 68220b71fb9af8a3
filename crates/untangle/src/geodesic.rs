//! Geodesic distance over the surface from some of its vertices, by fast marching (Kimmel and Sethian 1998).

use std::{cmp::Ordering, collections::BinaryHeap};

use crate::{
    frame::Frame,
    mesh::{Mesh, VertexId},
    sparse_map::SparseMap,
};

/// A front that spreads over the surface from where it was started, no farther than somebody asks: it continues when a
/// larger distance is asked for. It reuses its memory.
///
/// Distances are those of straight fronts within each triangle. Where two fronts meet, the distance comes out too short
/// by a part of an edge; nowhere is it too long.
///
/// Cost: O(n log n) in the vertices that the front has reached.
#[derive(Debug, Default)]
pub(crate) struct GeodesicFront {
    arrivals: SparseMap<VertexId, Arrival>,
    /// The trial vertices of the front; a vertex whose distance shrank stands here several times.
    trials: BinaryHeap<TrialVertex>,
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

/// A vertex of a front that is not final yet, in a heap: the nearest is first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TrialVertex {
    pub(crate) distance_m: f64,
    pub(crate) vertex: VertexId,
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

impl GeodesicFront {
    /// Takes all of the front away, and makes room for a mesh.
    pub(crate) fn reset(&mut self, num_vertices: usize) {
        self.arrivals.reset(num_vertices);
        self.trials.clear();
    }

    /// Takes a distance for a vertex, in metres, if it is shorter than the one so far: starts the front there.
    pub(crate) fn offer(&mut self, vertex: VertexId, distance_m: f64) {
        let arrival = self.arrivals.entry(vertex);
        if distance_m < arrival.distance_m {
            arrival.distance_m = distance_m;
            self.trials.push(TrialVertex { distance_m, vertex });
        }
    }

    /// The distance of a vertex in metres, once the front has passed it.
    pub(crate) fn passed(&self, vertex: VertexId) -> Option<f64> {
        let Arrival { distance_m, is_final } = self.arrival(vertex);
        is_final.then_some(distance_m)
    }

    /// The distance of the next vertex that the front would pass, in metres; nothing where it has passed all.
    pub(crate) fn next(&self) -> Option<f64> {
        self.trials.peek().map(|trial| trial.distance_m)
    }

    /// Vertices that the front has passed, and those on it, in the order in which it first touched them.
    pub(crate) fn touched(&self) -> &[VertexId] {
        self.arrivals.keys()
    }

    fn arrival(&self, vertex: VertexId) -> Arrival {
        self.arrivals.get(vertex).unwrap_or_default()
    }

    /// Passes the nearest trial vertex, and offers distances to its neighbours. Through a triangle whose other two
    /// corners are both at distance zero the front passes only if `is_source` says that it started on their edge.
    pub(crate) fn advance(&mut self, mesh: &Mesh, frame: &Frame, is_source: impl Fn([VertexId; 2]) -> bool) {
        let Some(TrialVertex { vertex, .. }) = self.trials.pop() else { return };
        if std::mem::replace(&mut self.arrivals.entry(vertex).is_final, true) {
            return;
        }
        for &face in mesh.vertex_faces(vertex) {
            let corners = mesh.face(face);
            for k in 0..3 {
                let (target, others) = (corners[k], [corners[(k + 1) % 3], corners[(k + 2) % 3]]);
                if !self.arrival(target).is_final {
                    let distance_m = self.update(frame, target, others, &is_source);
                    self.offer(target, distance_m);
                }
            }
        }
    }

    /// The distance of a vertex through the triangle with two others: that of a straight front where it enters between
    /// them, or else that along a side.
    fn update(
        &self,
        frame: &Frame,
        target: VertexId,
        others: [VertexId; 2],
        is_source: &impl Fn([VertexId; 2]) -> bool,
    ) -> f64 {
        let known = others.map(|vertex| self.passed(vertex).unwrap_or(f64::INFINITY));
        let sides = others.map(|vertex| frame.position(vertex) - frame.position(target));
        let along_sides = (known[0] + sides[0].norm()).min(known[1] + sides[1].norm());
        if !(known[0].is_finite() && known[1].is_finite()) {
            return along_sides;
        }
        // An edge between two vertices of the start cuts a corner off: the front does not start on it.
        if known.iter().all(|&distance| distance <= 0.0) && !is_source(others) {
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
