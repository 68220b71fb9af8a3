//! A path in a chart, followed without a jump also where the chart was cut.

use nalgebra::Point2;

use super::{
    chart::{Chart, turns},
    motion::Motion,
};
use crate::{
    mesh::{FaceId, Mesh},
    paths::{PathPoint, PathSegment, Sheet, SurfacePoint},
};

/// A closed path whose end lies farther from its start than this part of its length runs round a tube.
const ROUND: f64 = 0.3;

/// The points of a path on one of its two sheets, as they lie in a chart and its copies.
#[derive(Debug, Default)]
pub(crate) struct Lift {
    /// The points, one after the other in the plane. A path round a tube does not end where it starts.
    pub(crate) points: Vec<Point2<f64>>,
    /// For each segment the motion from its face, as it lies in the chart, to the copy in which the path runs there.
    motions: Vec<Motion>,
    /// For a closed path round a tube the motion from one round to the next.
    pub(crate) period: Option<Motion>,
}

impl Lift {
    /// Follows a path. False if a part of it lies outside of the chart.
    pub(crate) fn lay(
        &mut self,
        mesh: &Mesh,
        points: &[PathPoint],
        segments: &[PathSegment],
        sheet: Sheet,
        closed: bool,
        chart: &Chart,
    ) -> bool {
        self.points.clear();
        self.motions.clear();
        self.period = None;
        let mut motion = Motion::IDENTITY;
        for (index, point) in points.iter().enumerate() {
            let place = sheet.place(point);
            let face = segments.get(index).map(|segment| sheet.face(segment));
            let before = index.checked_sub(1).map(|before| sheet.face(&segments[before]));
            if let (Some(before), Some(face)) = (before, face)
                && let Some(joint) = joint(mesh, chart, before, face, place)
            {
                motion = motion.after(&joint);
            }
            let its_own = if let SurfacePoint::Face { face, .. } = *place { Some(face) } else { None };
            let mut faces = [its_own, face, before].into_iter().flatten();
            let Some(here) = faces.find_map(|face| chart.point_in(mesh, face, place)) else {
                return false;
            };
            self.points.push(motion.apply(here));
            if face.is_some() {
                self.motions.push(motion);
            }
        }
        if closed && let (Some(last), Some(first), Some(point)) = (segments.last(), segments.first(), points.first()) {
            let joint = joint(mesh, chart, sheet.face(last), sheet.face(first), sheet.place(point));
            let period = joint.map_or(motion, |joint| motion.after(&joint));
            let length: f64 = self.points.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
            if (period.apply(self.points[0]) - self.points[0]).norm() > ROUND * length {
                self.period = Some(period);
            }
        }
        self.points.len() >= 2
    }

    /// The corner of a face at which a path point lies, as it lies beside that point.
    pub(crate) fn corners(
        &self,
        chart: &Chart,
        segments: &[PathSegment],
        sheet: Sheet,
        index: usize,
    ) -> Option<(FaceId, [Point2<f64>; 3])> {
        let segment = index.min(segments.len() - 1);
        let face = sheet.face(&segments[segment]);
        Some((face, chart.corners(face)?.map(|corner| self.motions[segment].apply(corner))))
    }

    /// The copy of a point of the chart that is nearest to the path, and its distance from some of its points.
    pub(crate) fn nearest_copy(&self, chart: &Chart, point: Point2<f64>) -> (Point2<f64>, f64) {
        // Some sixty points of the path are enough to tell copies apart.
        let stride = self.points.len() / 60 + 1;
        let distance = |point: Point2<f64>| {
            let squared = self.points.iter().step_by(stride).map(|station| (station - point).norm_squared());
            squared.fold(f64::INFINITY, f64::min)
        };
        let copies = turns(self.period.or_else(|| chart.period())).map(|motion| motion.apply(point));
        let nearest = copies.map(|copy| (copy, distance(copy))).min_by(|a, b| a.1.total_cmp(&b.1));
        nearest.map_or((point, 0.0), |(copy, squared)| (copy, squared.sqrt()))
    }
}

/// The motion that puts a face beside the one before it where a path runs from one to the other; nothing where it lies there already.
fn joint(mesh: &Mesh, chart: &Chart, before: FaceId, face: FaceId, place: &SurfacePoint) -> Option<Motion> {
    if before == face {
        return None;
    }
    match *place {
        SurfacePoint::Edge { edge, .. } => {
            let ends = |face: FaceId| {
                let corners = chart.corners(face)?;
                let [a, b] = mesh.edge(edge).map(|end| mesh.face(face).iter().position(|&corner| corner == end));
                Some([corners[a?], corners[b?]])
            };
            let (from, to) = (ends(face)?, ends(before)?);
            if from == to { None } else { Motion::taking(from, to) }
        }
        SurfacePoint::Vertex(_) => {
            let (from, to) = (chart.point_in(mesh, face, place)?, chart.point_in(mesh, before, place)?);
            (from != to).then(|| Motion::shifting(from, to))
        }
        SurfacePoint::Face { .. } => None,
    }
}
