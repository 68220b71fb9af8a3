//! The two sheets along a path in the world: their conormals, and the directions in which they part.

use nalgebra::Vector3;

use super::{MaterialPoint, SeparationConstraint, chart::Chart};
use crate::{
    frame::Frame,
    mesh::{FaceId, Mesh},
    paths::{PathPoint, PathSegment},
};

/// A path between two sheets, with the charts of both.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sheets<'a> {
    pub(crate) mesh: &'a Mesh,
    pub(crate) frame: &'a Frame,
    pub(crate) points: &'a [PathPoint],
    pub(crate) segments: &'a [PathSegment],
    pub(crate) own: &'a Chart,
    pub(crate) partner: &'a Chart,
}

impl Sheets<'_> {
    /// The side of the corresponding path onto which the inside belongs where no region says it: the one whose half of the other
    /// sheet makes the smaller angle with the inside, on the average over the path.
    pub(crate) fn likelier_side(&self, side: f64) -> f64 {
        let mut agreement = 0.0;
        for index in 0..self.segments.len() {
            if let Some((inside, image)) = self.conormals(index, (side, 1.0)) {
                agreement += inside.dot(&image) * self.segment_length(index);
            }
        }
        if agreement >= 0.0 { 1.0 } else { -1.0 }
    }

    /// Adds the middles of all segments, with the direction in which the inside has to go there: the limit, on the path, of the
    /// way from a point inside to its target. Inside a point lies by `b`, its target by `b'`, times the same small distance.
    pub(crate) fn part(&self, sides: (f64, f64), share: f64, separations: &mut Vec<SeparationConstraint>) {
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

    /// The unit directions in the two sheets, at right angles to a segment, to the given sides of path and corresponding path.
    fn conormals(&self, index: usize, sides: (f64, f64)) -> Option<(Vector3<f64>, Vector3<f64>)> {
        let tangent = (self.points[index + 1].position - self.points[index].position).try_normalize(0.0)?;
        let segment = &self.segments[index];
        let inside = self.conormal(self.own, segment.own, tangent, sides.0)?;
        let image = self.conormal(self.partner, segment.partner, tangent, sides.1)?;
        Some((inside, image))
    }

    /// The unit direction in a face at right angles to a tangent of it, to the side where the chart has the left of the tangent, or for a
    /// negative `side` the right.
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
