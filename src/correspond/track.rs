//! A path in both charts: arclength, equidistant samples, and the side on which its region lies.

use nalgebra::{Point2, Vector2};

use super::chart::Chart;
use crate::{
    mesh::{EdgeId, Mesh, VertexId},
    paths::{PathPoint, SurfacePoint},
};

/// The points of one path copy in the chart of the path and in that of the corresponding path.
#[derive(Debug, Default)]
pub(crate) struct Track {
    /// Coordinates along the path.
    pub(crate) own: Vec<Point2<f64>>,
    /// Coordinates along the corresponding path.
    pub(crate) partner: Vec<Point2<f64>>,
    arclength: Vec<f64>,
    closed: bool,
    crossings: Vec<(EdgeId, f64, usize)>,
    loop_vertices: Vec<VertexId>,
}

/// On which of its two places a path is looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sheet {
    /// Along the path.
    Own,
    /// Along the corresponding path.
    Partner,
}

impl Track {
    /// Takes a path. False if one of its points lies outside of the charts.
    pub(crate) fn lay(
        &mut self,
        mesh: &Mesh,
        points: &[PathPoint],
        closed: bool,
        own: &Chart,
        partner: &Chart,
    ) -> bool {
        self.own.clear();
        self.partner.clear();
        self.arclength.clear();
        self.closed = closed;
        let mut length = 0.0;
        for (index, point) in points.iter().enumerate() {
            let (Some(u), Some(v)) = (own.point(mesh, &point.own), partner.point(mesh, &point.partner)) else {
                return false;
            };
            if index > 0 {
                length += (point.position - points[index - 1].position).norm();
            }
            self.own.push(u);
            self.partner.push(v);
            self.arclength.push(length);
        }
        self.own.len() >= 2
    }

    /// World length in metres.
    pub(crate) fn length(&self) -> f64 {
        self.arclength.last().copied().unwrap_or(0.0)
    }

    /// Writes `count` samples that are equidistant in the world: both ends of an open path, the start of a closed one once.
    pub(crate) fn sample(&self, count: usize, own: &mut Vec<Point2<f64>>, partner: &mut Vec<Point2<f64>>) {
        own.clear();
        partner.clear();
        let intervals = if self.closed { count } else { count.saturating_sub(1) }.max(1);
        let mut segment = 0;
        for k in 0..count {
            #[expect(clippy::cast_precision_loss, reason = "counts of at most a thousand")]
            let at = self.length() * k as f64 / intervals as f64;
            while segment + 2 < self.arclength.len() && self.arclength[segment + 1] < at {
                segment += 1;
            }
            let (start, end) = (self.arclength[segment], self.arclength[segment + 1]);
            let part = if end > start { ((at - start) / (end - start)).clamp(0.0, 1.0) } else { 0.0 };
            own.push(self.own[segment] + (self.own[segment + 1] - self.own[segment]) * part);
            partner.push(self.partner[segment] + (self.partner[segment + 1] - self.partner[segment]) * part);
        }
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
        sheet: Sheet,
        chart: &Chart,
        region: &[VertexId],
    ) -> Option<f64> {
        let last = if self.closed { points.len() - 1 } else { points.len() };
        self.crossings.clear();
        self.loop_vertices.clear();
        for (index, point) in points[..last].iter().enumerate() {
            match if sheet == Sheet::Own { point.own } else { point.partner } {
                SurfacePoint::Edge { edge, parameter } => self.crossings.push((edge, parameter, index)),
                SurfacePoint::Vertex(vertex) => self.loop_vertices.push(vertex),
                SurfacePoint::Face { .. } => {}
            }
        }
        self.crossings.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
        let coordinates = if sheet == Sheet::Own { &self.own } else { &self.partner };
        let mut votes = 0i64;
        for (k, &(edge, _, index)) in self.crossings.iter().enumerate() {
            let first = k == 0 || self.crossings[k - 1].0 != edge;
            let last = self.crossings.get(k + 1).is_none_or(|next| next.0 != edge);
            for (vertex, speaks) in mesh.edge(edge).into_iter().zip([first, last]) {
                if !speaks || self.loop_vertices.contains(&vertex) {
                    continue;
                }
                let Some(there) = chart.vertex(vertex) else { continue };
                let left = self.direction(coordinates, index).perp(&(there - coordinates[index]));
                let inside = region.binary_search(&vertex).is_ok();
                if left != 0.0 {
                    votes += if (left > 0.0) == inside { 1 } else { -1 };
                }
            }
        }
        if votes == 0 && self.closed && self.crossings.is_empty() {
            let area: f64 = coordinates.windows(2).map(|pair| pair[0].coords.perp(&pair[1].coords)).sum();
            return Some(if area >= 0.0 { 1.0 } else { -1.0 });
        }
        match votes {
            0 => None,
            1.. => Some(1.0),
            _ => Some(-1.0),
        }
    }

    /// Direction of travel at a point, from the neighbour before to the neighbour behind.
    fn direction(&self, coordinates: &[Point2<f64>], index: usize) -> Vector2<f64> {
        let last = coordinates.len() - 1;
        let before = match index {
            0 if self.closed => last.saturating_sub(1),
            0 => 0,
            _ => index - 1,
        };
        coordinates[(index + 1).min(last)] - coordinates[before]
    }
}
