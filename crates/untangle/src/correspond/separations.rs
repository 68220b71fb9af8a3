//! The two sheets along a path in the world: their conormals, and the directions in which they have to separate.

use nalgebra::Vector3;

use super::{
    chart_pair::ChartPair, charts::Chart, correspondences::SeparationConstraint, material_point::MaterialPoint,
    path_input::PathInput,
};
use crate::{
    frame::Frame,
    mesh::{FaceId, Mesh},
    paths::{PathPoint, PathSegment},
};

/// A path between two sheets, with the charts of both.
#[derive(Clone, Copy, Debug)]
pub(super) struct SheetsAlongPath<'a> {
    mesh: &'a Mesh,
    frame: &'a Frame,
    points: &'a [PathPoint],
    segments: &'a [PathSegment],
    own: &'a Chart,
    partner: &'a Chart,
}

impl<'a> SheetsAlongPath<'a> {
    /// The sheets of a path in its charts.
    pub(super) fn new(input: &PathInput<'a>, charts: &'a ChartPair) -> Self {
        let PathInput { mesh, frame, points, segments, .. } = *input;
        Self { mesh, frame, points, segments, own: charts.own(), partner: charts.partner() }
    }

    /// The side of the corresponding path to which the inside on `side` of the path belongs, where no region says so:
    /// the one whose half of the other sheet makes the smaller angle with the inside, on the mean over the path.
    pub(super) fn likelier_side(&self, side: f64) -> f64 {
        let mut agreement = 0.0;
        for index in 0..self.segments.len() {
            if let Some((inside, image)) = self.conormals(index, (side, 1.0)) {
                agreement += inside.dot(&image) * self.segment_length(index);
            }
        }
        if agreement >= 0.0 { 1.0 } else { -1.0 }
    }

    /// Adds a constraint at the middle of each segment, with the direction in which the inside has to move there: the
    /// limit, on the path, of the direction from a point inside to its target. Near the path a point inside is offset
    /// from it along the conormal `b` of its own sheet, its target along the conormal `b'` of the other, by the same
    /// small distance: so the limit is that of `b' - b`.
    ///
    /// `share` is the part of each segment's length that counts.
    pub(super) fn separate(&self, sides: (f64, f64), share: f64, separations: &mut Vec<SeparationConstraint>) {
        for (index, segment) in self.segments.iter().enumerate() {
            let Some((inside, image)) = self.conormals(index, sides) else { continue };
            let Some(direction) = (image - inside).try_normalize(1e-9) else { continue };
            let (start, end) = (&self.points[index], &self.points[index + 1]);
            let own = MaterialPoint::middle(self.mesh, segment.own, [&start.own, &end.own]);
            let partner = MaterialPoint::middle(self.mesh, segment.partner, [&start.partner, &end.partner]);
            let (Some(own), Some(partner)) = (own, partner) else { continue };
            let position = nalgebra::center(&start.position, &end.position);
            let length_m = self.segment_length(index) * share;
            separations.push(SeparationConstraint { own, partner, position, direction, length_m });
        }
    }

    fn segment_length(&self, index: usize) -> f64 {
        (self.points[index + 1].position - self.points[index].position).norm()
    }

    /// The unit conormals of the two sheets at a segment: in the sheet, at right angles to the segment, to the given
    /// sides of path and corresponding path.
    fn conormals(&self, index: usize, sides: (f64, f64)) -> Option<(Vector3<f64>, Vector3<f64>)> {
        let tangent = (self.points[index + 1].position - self.points[index].position).try_normalize(0.0)?;
        let segment = &self.segments[index];
        let inside = self.conormal(self.own, segment.own, tangent, sides.0)?;
        let image = self.conormal(self.partner, segment.partner, tangent, sides.1)?;
        Some((inside, image))
    }

    /// The unit direction in a face at right angles to a tangent of it, to the left of the tangent as the chart has it,
    /// or for a negative `side` to the right.
    fn conormal(&self, chart: &Chart, face: FaceId, tangent: Vector3<f64>, side: f64) -> Option<Vector3<f64>> {
        let [a, b, c] = chart.corners(face)?;
        let [x, y, z] = self.mesh.face(face);
        let x = self.frame.position(x);
        let normal = (self.frame.position(y) - x).cross(&(self.frame.position(z) - x));
        // Left in the world is left in the chart where both see the face wound the same way.
        let winding = (b - a).perp(&(c - a));
        (normal.cross(&tangent) * (side * winding.signum())).try_normalize(0.0)
    }
}
