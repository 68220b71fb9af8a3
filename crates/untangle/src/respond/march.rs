//! Distances to the boundary along the surface, as far from it as somebody asks.

use std::{cmp::Ordering, collections::BinaryHeap};

use crate::{
    frame::Frame,
    mesh::{Mesh, VertexId},
};

/// Fast marching from all boundaries of a mesh (Kimmel and Sethian 1998), which goes on where it stopped when it is asked again: all paths of a
/// frame share one march.
#[derive(Debug, Default)]
pub(crate) struct March {
    distances: Vec<f64>,
    is_final: Vec<bool>,
    /// Vertices with a distance, to be wiped.
    touched: Vec<VertexId>,
    heap: BinaryHeap<Candidate>,
    is_started: bool,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Candidate {
    distance: f64,
    vertex: VertexId,
}

impl Eq for Candidate {}

impl Ord for Candidate {
    fn cmp(&self, other: &Self) -> Ordering {
        // The heap gives the largest first.
        other.distance.total_cmp(&self.distance).then(other.vertex.cmp(&self.vertex))
    }
}

impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl March {
    /// Forgets the last frame.
    ///
    /// Cost: linear in what was marched over.
    pub(crate) fn forget(&mut self) {
        for vertex in self.touched.drain(..) {
            self.distances[vertex.index()] = f64::INFINITY;
            self.is_final[vertex.index()] = false;
        }
        self.heap.clear();
        self.is_started = false;
    }

    /// The distance of a vertex from the nearest boundary along the surface, in metres; nothing where it is more than `farthest_m`.
    ///
    /// Cost: over all calls for one frame O(n log n) in the vertices that are no farther from a boundary than the farthest one asked for; with the
    /// first, linear in the vertices of the mesh.
    pub(crate) fn distance_m(&mut self, mesh: &Mesh, frame: &Frame, vertex: VertexId, farthest_m: f64) -> Option<f64> {
        if !self.is_started {
            self.start(mesh);
        }
        while !self.is_final[vertex.index()] && self.heap.peek().is_some_and(|next| next.distance <= farthest_m) {
            self.step(mesh, frame);
        }
        let is_known = self.is_final[vertex.index()];
        is_known.then(|| self.distances[vertex.index()]).filter(|&distance| distance <= farthest_m)
    }

    fn start(&mut self, mesh: &Mesh) {
        self.is_started = true;
        self.distances.resize(mesh.num_vertices(), f64::INFINITY);
        self.is_final.resize(mesh.num_vertices(), false);
        for vertex in mesh.vertex_ids().filter(|&vertex| mesh.is_boundary_vertex(vertex)) {
            self.offer(vertex, 0.0);
        }
    }

    fn offer(&mut self, vertex: VertexId, distance: f64) {
        let slot = &mut self.distances[vertex.index()];
        if distance < *slot {
            if slot.is_infinite() {
                self.touched.push(vertex);
            }
            *slot = distance;
            self.heap.push(Candidate { distance, vertex });
        }
    }

    /// Makes the nearest candidate final, and its neighbours candidates.
    fn step(&mut self, mesh: &Mesh, frame: &Frame) {
        let Some(Candidate { vertex, .. }) = self.heap.pop() else { return };
        if std::mem::replace(&mut self.is_final[vertex.index()], true) {
            return;
        }
        for &face in mesh.vertex_faces(vertex) {
            let corners = mesh.face(face);
            for k in 0..3 {
                let (target, others) = (corners[k], [corners[(k + 1) % 3], corners[(k + 2) % 3]]);
                if !self.is_final[target.index()] {
                    let distance = self.update(mesh, frame, target, others);
                    self.offer(target, distance);
                }
            }
        }
    }

    /// The distance of a vertex through the triangle with two others: by a straight front where it enters between them, else along a side.
    fn update(&self, mesh: &Mesh, frame: &Frame, target: VertexId, others: [VertexId; 2]) -> f64 {
        let known = others
            .map(|vertex| if self.is_final[vertex.index()] { self.distances[vertex.index()] } else { f64::INFINITY });
        let sides = others.map(|vertex| frame.position(vertex) - frame.position(target));
        let along_sides = (known[0] + sides[0].norm()).min(known[1] + sides[1].norm());
        if !(known[0].is_finite() && known[1].is_finite()) {
            return along_sides;
        }
        // An inner edge from boundary to boundary cuts a corner: the front does not start all along it.
        if known.iter().all(|&distance| distance <= 0.0) && !is_boundary_edge(mesh, others) {
            return along_sides;
        }
        // The front is the plane wave with slope 1 through both values: |Q^-1 (values - d)| = 1 in the frame of the two sides.
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
    fn distances_to_the_boundary_of_a_sheet() {
        let (mesh, frame, positions) = sheet();
        let mut march = March::default();
        for (vertex, [x, y, _]) in mesh.vertex_ids().zip(positions) {
            let expected = x.min(1.0 - x).min(y).min(1.2 - y);
            let found = march.distance_m(&mesh, &frame, vertex, 9.0).unwrap();
            // Where two fronts meet, the last edge is cut short; nowhere is the way longer than it is.
            assert!(found < expected + 1e-9 && found > expected - 0.05, "{vertex:?}: {found} {expected}");
        }
    }

    #[test]
    fn a_march_stops_early_and_goes_on_as_if_it_had_not() {
        let (mesh, frame, _) = sheet();
        let mut all = March::default();
        let expected: Vec<f64> =
            mesh.vertex_ids().map(|vertex| all.distance_m(&mesh, &frame, vertex, 9.0).unwrap()).collect();
        let mut march = March::default();
        for _ in 0..2 {
            let middle = VertexId(6 * 11 + 5);
            assert_eq!(march.distance_m(&mesh, &frame, VertexId(2 * 11 + 1), 9.0), Some(expected[2 * 11 + 1]));
            assert!(!march.is_final[middle.index()]);
            assert_eq!(march.distance_m(&mesh, &frame, middle, 0.2), None);
            for (vertex, &expected) in mesh.vertex_ids().zip(&expected) {
                let found = march.distance_m(&mesh, &frame, vertex, 9.0);
                assert_eq!(found.map(f64::to_bits), Some(expected.to_bits()));
                // What is known already is still too far for some.
                assert_eq!(march.distance_m(&mesh, &frame, vertex, 0.2).is_some(), expected <= 0.2);
            }
            march.forget();
            assert!(march.distances.iter().all(|distance| distance.is_infinite()));
        }
    }
}
