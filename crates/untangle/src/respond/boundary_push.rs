//! BI paths: a force that pushes the intersection over the nearest boundary.
//!
//! Section 5.1, equations 5 to 7, of Wicke, Lanker and Gross (2006), with these differences: the distance to the
//! boundary is measured along the surface in its present lengths, so that its gradient is a direction of the world at
//! once; the magnitude is the `min` law with the offset; and the force acts on the path itself, spread over the corners
//! of its faces, against its opposite in the same place of the other sheet, so that angular momentum is kept too.

use nalgebra::{Vector2, Vector3};

use super::{boundary_distance::BoundaryDistance, forces::ForceLaw};
use crate::{
    correspond::{Chart, MaterialPoint},
    frame::Frame,
    mesh::{FaceId, Mesh},
    paths::{PathPoint, PathSegment, Sheet},
    settings::Settings,
};

/// A mean below this part of the mean magnitude counts as cancelled: the path straddles the line from which two
/// boundaries are equally far.
const CANCELLED: f64 = 0.3;

/// Finds the directions over the boundary, reusing its memory.
#[derive(Debug, Default)]
pub(crate) struct BoundaryPush {
    chart: Chart,
    distance: BoundaryDistance,
    /// For each segment of a path the distance to the boundary in its middle, in metres, and the direction in which it
    /// shrinks, in the chart.
    slopes: Vec<Option<(f64, Vector2<f64>)>>,
}

/// How far a path has to go over a boundary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PushDepth {
    /// Mean distance to the boundary, in metres.
    pub(crate) mean_m: f64,
    /// Greatest distance to the boundary, in metres.
    pub(crate) greatest_m: f64,
}

/// A path to be pushed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PushedPath<'a> {
    pub(crate) mesh: &'a Mesh,
    pub(crate) frame: &'a Frame,
    pub(crate) points: &'a [PathPoint],
    pub(crate) segments: &'a [PathSegment],
    pub(crate) settings: &'a Settings,
    pub(crate) edge_length_m: f64,
}

impl BoundaryPush {
    /// Makes ready for another frame.
    pub(crate) fn reset(&mut self) {
        self.distance.reset();
    }

    /// Writes for each segment the displacement of one step, in metres, towards the boundary of `sheet`: the mean over
    /// the path, taken in a chart, so that it follows a sheet that bends. Returns how far it is to the boundary;
    /// nothing, and zeros, where no boundary is near or the directions cancel.
    ///
    /// Cost: linear in the path, and over all paths of a frame that of one [`BoundaryDistance`].
    pub(crate) fn steps(
        &mut self,
        path: &PushedPath<'_>,
        sheet: Sheet,
        steps: &mut Vec<Vector3<f64>>,
    ) -> Option<PushDepth> {
        let PushedPath { mesh, frame, points, segments, settings, edge_length_m } = *path;
        steps.clear();
        steps.resize(segments.len(), Vector3::zeros());
        let length: f64 = points.windows(2).map(|pair| (pair[1].position - pair[0].position).norm()).sum();
        let face_of = |segment: &PathSegment| sheet.face(segment);
        self.chart.patch_mut().start(mesh, segments.iter().map(face_of));
        self.chart.patch_mut().grow(mesh, 1, usize::MAX);
        self.chart.build(mesh, frame)?;
        // The path itself ends on a boundary: one that is much farther away than the length of the path does not count.
        self.find_slopes(path, sheet, 1.5 * length + 3.0 * edge_length_m);
        let greatest_m = self.slopes.iter().flatten().map(|(distance_m, _)| *distance_m).fold(0.0, f64::max);
        let law = ForceLaw::of_push(settings, edge_length_m, greatest_m);
        let (mut mean, mut magnitude, mut mean_m) = (Vector2::zeros(), 0.0, 0.0);
        for (ends, slope) in points.windows(2).zip(&self.slopes) {
            let Some((distance_m, downhill)) = *slope else { continue };
            let part = (ends[1].position - ends[0].position).norm() / length;
            let step = law.step(distance_m) * part;
            mean_m += distance_m * part;
            mean += downhill * step;
            magnitude += step;
        }
        if mean.norm() <= CANCELLED * magnitude {
            return None;
        }
        for (step, segment) in steps.iter_mut().zip(segments) {
            if let Some(direction) = self.chart.to_world(mesh, frame, face_of(segment), mean) {
                *step = direction * mean.norm();
            }
        }
        Some(PushDepth { mean_m, greatest_m })
    }

    /// Looks in the middle of each segment how far the boundary is, no farther than `farthest_m`, and where.
    fn find_slopes(&mut self, path: &PushedPath<'_>, sheet: Sheet, farthest_m: f64) {
        let PushedPath { mesh, frame, points, segments, .. } = *path;
        self.slopes.clear();
        for (ends, segment) in points.windows(2).zip(segments) {
            let face = sheet.face(segment);
            let middle = MaterialPoint::middle(mesh, face, [sheet.place(&ends[0]), sheet.place(&ends[1])]);
            let slope = middle.and_then(|at| self.slope(mesh, frame, face, &at, farthest_m));
            let downhill = slope.and_then(|(distance_m, downhill)| {
                Some((distance_m, self.chart.to_chart(mesh, frame, face, downhill)?))
            });
            self.slopes.push(downhill);
        }
    }

    /// Distance to the boundary at a point of a face and the unit direction in which it shrinks fastest.
    fn slope(
        &mut self,
        mesh: &Mesh,
        frame: &Frame,
        face: FaceId,
        at: &MaterialPoint,
        farthest_m: f64,
    ) -> Option<(f64, Vector3<f64>)> {
        let mut values = [0.0; 3];
        for (value, vertex) in values.iter_mut().zip(mesh.face(face)) {
            *value = self.distance.distance_m(mesh, frame, vertex, farthest_m)?;
        }
        let distance = values.iter().zip(at.weights).map(|(value, weight)| value * weight).sum::<f64>();
        let [a, b, c] = mesh.face(face).map(|vertex| frame.position(vertex));
        let normal = (b - a).cross(&(c - a));
        // Gradient of the linear function: each value times the height direction of its corner.
        let gradient = normal.cross(&(c - b)) * values[0]
            + normal.cross(&(a - c)) * values[1]
            + normal.cross(&(b - a)) * values[2];
        let downhill = (-gradient).try_normalize(0.0)?;
        (distance.is_finite() && downhill.iter().all(|value| value.is_finite())).then_some((distance, downhill))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::correspond::samples::sheet;

    #[test]
    fn slope_on_strip_points_to_the_nearer_side() {
        let (mesh, flat) = sheet(8, 20, 0.1);
        let positions: Vec<_> = flat.iter().map(|point| [point.x, point.y, 0.0]).collect();
        let frame = Frame::new(&mesh, &positions).unwrap();
        let mut push = BoundaryPush::default();
        for (column, direction) in [(1, -1.0), (6, 1.0)] {
            let face = FaceId(2 * (10 * 8 + column));
            let at = MaterialPoint { vertices: mesh.face(face), weights: [0.4, 0.3, 0.3] };
            let (distance, downhill) = push.slope(&mesh, &frame, face, &at, 1.0).unwrap();
            let x = at.position(&frame).x;
            assert!((distance - x.min(0.8 - x)).abs() < 0.03);
            assert!((downhill - Vector3::x() * direction).norm() < 0.1);
            assert_eq!(push.slope(&mesh, &frame, face, &at, 0.5 * distance), None);
        }
    }
}
