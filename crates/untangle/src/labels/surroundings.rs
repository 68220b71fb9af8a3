//! What lies round one path, by its geodesic distance from it.

use nalgebra::Point3;

use crate::{
    analysis::Analysis,
    frame::Frame,
    geodesic::GeodesicFront,
    mesh::{Mesh, VertexId},
    paths::PathCopy,
};

/// The surroundings of one path, as far as they were asked for; reuses its memory from path to path.
#[derive(Debug, Default)]
pub(super) struct Surroundings {
    front: GeodesicFront,
    /// Corners of the faces that the path runs through.
    num_corners: usize,
}

impl Surroundings {
    /// Starts from a path.
    pub(super) fn start(&mut self, mesh: &Mesh, frame: &Frame, analysis: &Analysis, copy: &PathCopy) {
        self.front.reset(mesh.num_vertices());
        let points = &analysis.paths.points[copy.points.clone()];
        let segments = &analysis.paths.segments[copy.segments.clone()];
        for (ends, segment) in points.windows(2).zip(segments) {
            let ends = [ends[0].position, ends[1].position];
            for vertex in mesh.face(segment.own) {
                self.front.offer(vertex, distance_m(frame.position(vertex), ends));
            }
        }
        self.num_corners = self.front.touched().len();
    }

    /// The largest distance from the path to some vertices of its piece, in metres; zero where there are none.
    pub(super) fn depth_m(&mut self, mesh: &Mesh, frame: &Frame, vertices: &[VertexId]) -> f64 {
        let mut depth_m: f64 = 0.0;
        for &vertex in vertices {
            while self.front.passed(vertex).is_none() && self.front.next().is_some() {
                self.advance(mesh, frame);
            }
            depth_m = depth_m.max(self.front.passed(vertex).unwrap_or(0.0));
        }
        depth_m
    }

    /// Calls `visit` with each vertex no farther than `near_m` from the path, each corner of the faces that it runs
    /// through, and each vertex no farther than `reach_m`, and whether it is one of the former.
    pub(super) fn visit(
        &mut self,
        mesh: &Mesh,
        frame: &Frame,
        [near_m, reach_m]: [f64; 2],
        mut visit: impl FnMut(VertexId, bool),
    ) {
        let farthest_m = near_m.max(reach_m);
        while self.front.next().is_some_and(|next| next <= farthest_m) {
            self.advance(mesh, frame);
        }
        for (place, &vertex) in self.front.touched().iter().enumerate() {
            let is_corner = place < self.num_corners;
            let distance_m = self.front.passed(vertex).unwrap_or(f64::INFINITY);
            if is_corner || distance_m <= farthest_m {
                visit(vertex, is_corner || distance_m <= near_m);
            }
        }
    }

    fn advance(&mut self, mesh: &Mesh, frame: &Frame) {
        // Corners at distance zero are few, where the path runs through a vertex.
        self.front.advance(mesh, frame, |_| false);
    }
}

/// Distance of a point from a straight line between two points.
fn distance_m(point: Point3<f64>, [start, end]: [Point3<f64>; 2]) -> f64 {
    let along = end - start;
    let squared = along.norm_squared();
    let part = if squared > 0.0 { ((point - start).dot(&along) / squared).clamp(0.0, 1.0) } else { 0.0 };
    (start + along * part - point).norm()
}
