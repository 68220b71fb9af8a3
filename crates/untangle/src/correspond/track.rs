//! A path in both charts: arclength, samples, and the side on which its region lies.

use nalgebra::{Point2, Vector2};

use super::{chart::Chart, lift::Lift};
use crate::{
    mesh::{EdgeId, Mesh, VertexId},
    paths::{PathPoint, PathSegment, Sheet, SurfacePoint},
};

/// A path round a tube is sampled beyond both ends by this part of its length, so that the fit has no end there.
const BEYOND: f64 = 0.25;

/// The points of one path copy in the chart of the path and in that of the corresponding path.
#[derive(Debug, Default)]
pub(crate) struct Track {
    /// Coordinates along the path.
    pub(crate) own: Lift,
    /// Coordinates along the corresponding path.
    pub(crate) partner: Lift,
    arclength: Vec<f64>,
    closed: bool,
    /// Whether path and corresponding path are exchanged.
    is_turned: bool,
    crossings: Vec<(EdgeId, f64, usize)>,
    loop_vertices: Vec<VertexId>,
}

impl Track {
    /// Takes a path in its own chart. False if a part of it lies outside of it.
    pub(crate) fn lay_own(
        &mut self,
        mesh: &Mesh,
        points: &[PathPoint],
        segments: &[PathSegment],
        closed: bool,
        chart: &Chart,
    ) -> bool {
        self.arclength.clear();
        self.closed = closed;
        let mut length = 0.0;
        for (index, point) in points.iter().enumerate() {
            if index > 0 {
                length += (point.position - points[index - 1].position).norm();
            }
            self.arclength.push(length);
        }
        self.own.lay(mesh, points, segments, Sheet::Own, closed, chart)
    }

    /// The same in the chart of the corresponding path.
    pub(crate) fn lay_partner(
        &mut self,
        mesh: &Mesh,
        points: &[PathPoint],
        segments: &[PathSegment],
        chart: &Chart,
    ) -> bool {
        self.partner.lay(mesh, points, segments, Sheet::Partner, self.closed, chart)
    }

    /// Exchanges path and corresponding path, until [`face_own`](Self::face_own).
    pub(crate) fn face_partner(&mut self) {
        std::mem::swap(&mut self.own, &mut self.partner);
        self.is_turned = !self.is_turned;
    }

    /// Undoes [`face_partner`](Self::face_partner): the next frame shall find memory of the same size.
    pub(crate) fn face_own(&mut self) {
        if self.is_turned {
            self.face_partner();
        }
    }

    /// Whether the path runs round a tube on one of its sheets.
    fn is_round(&self) -> bool {
        self.own.period.is_some() || self.partner.period.is_some()
    }

    /// Whether only the corresponding path runs round a tube: then the inside is a disc whose image has no single value.
    pub(crate) fn winds_off(&self) -> bool {
        self.own.period.is_none() && self.partner.period.is_some()
    }

    /// World length in metres.
    pub(crate) fn length(&self) -> f64 {
        self.arclength.last().copied().unwrap_or(0.0)
    }

    /// Writes the arclengths of `count` samples that are equidistant in the world: both ends of an open path, the start of a closed one
    /// once, more on either side of a path round a tube.
    pub(crate) fn stations(&self, count: usize, stations: &mut Vec<f64>) {
        stations.clear();
        let (first, last, intervals) = match (self.closed, self.is_round()) {
            (true, true) => (-BEYOND, 1.0 + BEYOND, count.saturating_sub(1)),
            (true, false) => (0.0, 1.0, count),
            (false, _) => (0.0, 1.0, count.saturating_sub(1)),
        };
        #[expect(clippy::cast_precision_loss, reason = "counts of at most a thousand")]
        let step = (last - first) / intervals.max(1) as f64;
        #[expect(clippy::cast_precision_loss, reason = "counts of at most a thousand")]
        stations.extend((0..count).map(|k| self.length() * (first + step * k as f64)));
    }

    /// How much of a path round a tube is sampled, as a multiple of its length; 1 for others.
    pub(crate) fn sampled_part(&self) -> f64 {
        if self.closed && self.is_round() { 1.0 + 2.0 * BEYOND } else { 1.0 }
    }

    /// Where the path lies at an arclength in metres: on its own sheet, on the other, and the number of its segment. A path round a
    /// tube goes on beyond its ends, others stop there.
    pub(crate) fn at(&self, arclength_m: f64) -> (Point2<f64>, Point2<f64>, usize) {
        let length = self.length();
        let rounds = if self.is_round() && length > 0.0 { (arclength_m / length).floor() } else { 0.0 };
        let at = arclength_m - rounds * length;
        let last = self.arclength.len() - 2;
        let segment = self.arclength.partition_point(|&there| there <= at).saturating_sub(1).min(last);
        let (start, end) = (self.arclength[segment], self.arclength[segment + 1]);
        let part = if end > start { ((at - start) / (end - start)).clamp(0.0, 1.0) } else { 0.0 };
        #[expect(clippy::cast_possible_truncation, reason = "one round more or less than none")]
        let rounds = rounds as i32;
        let place = |lift: &Lift| {
            let point = lift.points[segment] + (lift.points[segment + 1] - lift.points[segment]) * part;
            lift.period.map_or(point, |period| period.times(rounds).apply(point))
        };
        (place(&self.own), place(&self.partner), segment)
    }

    /// The points of the corresponding path with their arclengths.
    pub(crate) fn partner_points(&self) -> impl Iterator<Item = (f64, Point2<f64>)> + '_ {
        self.arclength.iter().copied().zip(self.partner.points.iter().copied())
    }

    /// On which side a region lies: 1 for the left of the direction of travel, -1 for the right, in the coordinates of the chart.
    ///
    /// Every crossing of an edge has next to it, up to the neighbouring crossing or the end of the edge, points of one side only;
    /// where that is the end of the edge, its vertex says whether this is the inside. A closed path that crosses no edge holds its
    /// region within.
    pub(crate) fn region_side(
        &mut self,
        mesh: &Mesh,
        points: &[PathPoint],
        segments: &[PathSegment],
        sheet: Sheet,
        chart: &Chart,
        region: &[VertexId],
    ) -> Option<f64> {
        let last = if self.closed { points.len() - 1 } else { points.len() };
        self.crossings.clear();
        self.loop_vertices.clear();
        for (index, point) in points[..last].iter().enumerate() {
            match *sheet.place(point) {
                SurfacePoint::Edge { edge, parameter } => self.crossings.push((edge, parameter, index)),
                SurfacePoint::Vertex(vertex) => self.loop_vertices.push(vertex),
                SurfacePoint::Face { .. } => {}
            }
        }
        self.crossings.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
        let lift = if sheet == Sheet::Own { &self.own } else { &self.partner };
        let mut votes = 0i64;
        for (k, &(edge, _, index)) in self.crossings.iter().enumerate() {
            let first = k == 0 || self.crossings[k - 1].0 != edge;
            let last = self.crossings.get(k + 1).is_none_or(|next| next.0 != edge);
            let Some((face, corners)) = lift.corners(chart, segments, sheet, index) else { continue };
            for (vertex, speaks) in mesh.edge(edge).into_iter().zip([first, last]) {
                if !speaks || self.loop_vertices.contains(&vertex) {
                    continue;
                }
                let Some(corner) = mesh.face(face).iter().position(|&corner| corner == vertex) else { continue };
                let left = self.direction(lift, index).perp(&(corners[corner] - lift.points[index]));
                let inside = region.binary_search(&vertex).is_ok();
                if left != 0.0 {
                    votes += if (left > 0.0) == inside { 1 } else { -1 };
                }
            }
        }
        if votes == 0 && self.closed && self.crossings.is_empty() {
            let area: f64 = lift.points.windows(2).map(|pair| pair[0].coords.perp(&pair[1].coords)).sum();
            return Some(if area >= 0.0 { 1.0 } else { -1.0 });
        }
        match votes {
            0 => None,
            1.. => Some(1.0),
            _ => Some(-1.0),
        }
    }

    /// Direction of travel at a point, from the neighbour before to the neighbour behind.
    fn direction(&self, lift: &Lift, index: usize) -> Vector2<f64> {
        let points = &lift.points;
        let last = points.len() - 1;
        let before = match index {
            0 if self.closed && lift.period.is_none() => last.saturating_sub(1),
            0 => 0,
            _ => index - 1,
        };
        points[(index + 1).min(last)] - points[before]
    }
}
