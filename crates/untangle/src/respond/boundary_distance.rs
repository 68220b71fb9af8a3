//! Geodesic distance of vertices from the boundary, no farther than somebody asks.

use crate::{
    frame::Frame,
    geodesic::GeodesicFront,
    mesh::{Mesh, VertexId},
};

/// Distances along the surface from all boundaries of a mesh. The front stops at the distance asked for and continues
/// from there when a larger one is asked for: all paths of a frame share it.
#[derive(Debug, Default)]
pub(crate) struct BoundaryDistance {
    front: GeodesicFront,
    is_started: bool,
}

impl BoundaryDistance {
    /// Makes ready for another frame.
    pub(crate) fn reset(&mut self) {
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
        let front = &mut self.front;
        while front.passed(vertex).is_none() && front.next().is_some_and(|next| next <= farthest_m) {
            front.advance(mesh, frame, |ends| is_boundary_edge(mesh, ends));
        }
        front.passed(vertex).filter(|&distance_m| distance_m <= farthest_m)
    }

    fn start(&mut self, mesh: &Mesh) {
        self.is_started = true;
        self.front.reset(mesh.num_vertices());
        for vertex in mesh.vertex_ids().filter(|&vertex| mesh.is_boundary_vertex(vertex)) {
            self.front.offer(vertex, 0.0);
        }
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
            assert_eq!(distance.front.passed(middle), None);
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
