//! A path in both charts: its lifts on both sheets, with one arclength.

use nalgebra::Point2;

use super::path::LiftedPath;
use crate::{
    correspond::charts::Chart,
    mesh::{EdgeId, Mesh, VertexId},
    paths::{PathPoint, PathSegment, Sheet},
};

/// A path that winds round a tube is sampled beyond both ends by this part of its length, so that the fit has no end
/// there.
const BEYOND_ENDS: f64 = 0.25;

/// The lifts of a path in its own chart and in that of the corresponding path.
#[derive(Debug, Default)]
pub(crate) struct LiftedPair {
    /// On the sheet of the path.
    pub(crate) own: LiftedPath,
    /// On the sheet of the corresponding path.
    pub(crate) partner: LiftedPath,
    /// Of each point, in metres of the world.
    arclength: Vec<f64>,
    pub(super) closed: bool,
    /// Whether path and corresponding path are exchanged.
    is_exchanged: bool,
    /// Scratch of [`region_side`](Self::region_side): edge, parameter and point of each crossing of an edge, and the
    /// vertices that the path runs through.
    pub(super) crossings: Vec<(EdgeId, f64, usize)>,
    pub(super) loop_vertices: Vec<VertexId>,
}

impl LiftedPair {
    /// Takes a path, and lifts it in its own chart. False if a part of it lies outside of the chart.
    pub(crate) fn lift_own(
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
        self.own.lift(mesh, points, segments, Sheet::Own, closed, chart)
    }

    /// Lifts the path taken by [`lift_own`](Self::lift_own) in the chart of the corresponding path. False if a part of
    /// it lies outside of the chart.
    pub(crate) fn lift_partner(
        &mut self,
        mesh: &Mesh,
        points: &[PathPoint],
        segments: &[PathSegment],
        chart: &Chart,
    ) -> bool {
        self.partner.lift(mesh, points, segments, Sheet::Partner, self.closed, chart)
    }

    /// Exchanges path and corresponding path, until [`undo_exchange`](Self::undo_exchange).
    pub(crate) fn exchange(&mut self) {
        std::mem::swap(&mut self.own, &mut self.partner);
        self.is_exchanged = !self.is_exchanged;
    }

    /// Undoes [`exchange`](Self::exchange), if there was one: so that the same path of the next frame finds memory of
    /// the size that it needs.
    pub(crate) fn undo_exchange(&mut self) {
        if self.is_exchanged {
            self.exchange();
        }
    }

    /// Whether the path winds round a tube on one of its sheets.
    fn winds(&self) -> bool {
        self.own.period.is_some() || self.partner.period.is_some()
    }

    /// Whether path and corresponding path both wind round a tube.
    pub(crate) fn both_wind(&self) -> bool {
        self.own.period.is_some() && self.partner.period.is_some()
    }

    /// Whether only the corresponding path winds round a tube: then the inside is a disc, and no single-valued map of
    /// the plane takes it to its image.
    pub(crate) fn only_partner_winds(&self) -> bool {
        self.own.period.is_none() && self.partner.period.is_some()
    }

    /// World length in metres.
    pub(crate) fn length(&self) -> f64 {
        self.arclength.last().copied().unwrap_or(0.0)
    }

    /// Writes the arclengths of `count` samples that are equidistant in the world: both ends of an open path, the start
    /// of a closed one once; of a path that winds round a tube beyond both ends.
    pub(crate) fn sample(&self, count: usize, stations: &mut Vec<f64>) {
        stations.clear();
        let (first, last, intervals) = match (self.closed, self.winds()) {
            (true, true) => (-BEYOND_ENDS, 1.0 + BEYOND_ENDS, count.saturating_sub(1)),
            (true, false) => (0.0, 1.0, count),
            (false, _) => (0.0, 1.0, count.saturating_sub(1)),
        };
        #[expect(clippy::cast_precision_loss, reason = "counts of at most a thousand")]
        let step = (last - first) / intervals.max(1) as f64;
        #[expect(clippy::cast_precision_loss, reason = "counts of at most a thousand")]
        stations.extend((0..count).map(|k| self.length() * (first + step * k as f64)));
    }

    /// The length that is sampled, as a multiple of the path's length: 1 for a path that does not wind.
    pub(crate) fn sampled_part(&self) -> f64 {
        if self.closed && self.winds() { 1.0 + 2.0 * BEYOND_ENDS } else { 1.0 }
    }

    /// Where the path lies at an arclength in metres, on its own sheet and on the other. A path that winds round a tube
    /// goes on beyond its ends, others stop there.
    pub(crate) fn at_arclength(&self, arclength_m: f64) -> (Point2<f64>, Point2<f64>) {
        let length = self.length();
        let rounds = if self.winds() && length > 0.0 { (arclength_m / length).floor() } else { 0.0 };
        let at = arclength_m - rounds * length;
        let last = self.arclength.len() - 2;
        let segment = self.arclength.partition_point(|&there| there <= at).saturating_sub(1).min(last);
        let (start, end) = (self.arclength[segment], self.arclength[segment + 1]);
        let part = if end > start { ((at - start) / (end - start)).clamp(0.0, 1.0) } else { 0.0 };
        #[expect(clippy::cast_possible_truncation, reason = "one round more or less than none")]
        let rounds = rounds as i32;
        let place = |path: &LiftedPath| {
            let point = path.points[segment] + (path.points[segment + 1] - path.points[segment]) * part;
            path.period.map_or(point, |period| period.power(rounds).apply(point))
        };
        (place(&self.own), place(&self.partner))
    }

    /// The points of the corresponding path with their arclengths.
    pub(crate) fn partner_points(&self) -> impl Iterator<Item = (f64, Point2<f64>)> + '_ {
        self.arclength.iter().copied().zip(self.partner.points.iter().copied())
    }
}
