//! The side of a path on which its region lies, by a vote of the edges that it crosses.

use nalgebra::Vector2;

use super::{pair::LiftedPair, path::LiftedPath};
use crate::{
    correspond::charts::Chart,
    mesh::{Mesh, VertexId},
    paths::{PathPoint, PathSegment, Sheet, SurfacePoint},
};

impl LiftedPair {
    /// On which side a region lies: 1 for the left of the direction of travel, -1 for the right, in the coordinates of
    /// the chart. Nothing where the votes are even.
    ///
    /// Next to every crossing of an edge, up to the neighbouring crossing or the end of the edge, points lie on one
    /// side only. Where that is the end of the edge, its vertex votes: it is inside or not. A closed path that crosses
    /// no edge holds its region within.
    pub(crate) fn region_side(
        &mut self,
        mesh: &Mesh,
        points: &[PathPoint],
        segments: &[PathSegment],
        sheet: Sheet,
        chart: &Chart,
        region: &[VertexId],
    ) -> Option<f64> {
        self.collect_crossings(points, sheet);
        let path = if sheet == Sheet::Own { &self.own } else { &self.partner };
        let mut votes = 0i64;
        for (k, &(edge, _, index)) in self.crossings.iter().enumerate() {
            let is_first = k == 0 || self.crossings[k - 1].0 != edge;
            let is_last = self.crossings.get(k + 1).is_none_or(|next| next.0 != edge);
            let Some((face, corners)) = path.corners(chart, segments, sheet, index) else { continue };
            for (vertex, has_vote) in mesh.edge(edge).into_iter().zip([is_first, is_last]) {
                if !has_vote || self.loop_vertices.contains(&vertex) {
                    continue;
                }
                let Some(corner) = mesh.face(face).iter().position(|&corner| corner == vertex) else { continue };
                let left = direction(path, self.closed, index).perp(&(corners[corner] - path.points[index]));
                let is_inside = region.binary_search(&vertex).is_ok();
                if left != 0.0 {
                    votes += if (left > 0.0) == is_inside { 1 } else { -1 };
                }
            }
        }
        if votes == 0 && self.closed && self.crossings.is_empty() {
            let area: f64 = path.points.windows(2).map(|pair| pair[0].coords.perp(&pair[1].coords)).sum();
            return Some(if area >= 0.0 { 1.0 } else { -1.0 });
        }
        match votes {
            0 => None,
            1.. => Some(1.0),
            _ => Some(-1.0),
        }
    }

    /// Collects where the path crosses edges of a sheet, edge by edge, and the vertices that it runs through.
    fn collect_crossings(&mut self, points: &[PathPoint], sheet: Sheet) {
        let num_distinct = if self.closed { points.len() - 1 } else { points.len() };
        self.crossings.clear();
        self.loop_vertices.clear();
        for (index, point) in points[..num_distinct].iter().enumerate() {
            match *sheet.place(point) {
                SurfacePoint::Edge { edge, parameter } => self.crossings.push((edge, parameter, index)),
                SurfacePoint::Vertex(vertex) => self.loop_vertices.push(vertex),
                SurfacePoint::Face { .. } => {}
            }
        }
        self.crossings.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
    }
}

/// Direction of travel at a point, from the neighbour before to the neighbour behind.
fn direction(path: &LiftedPath, closed: bool, index: usize) -> Vector2<f64> {
    let points = &path.points;
    let last = points.len() - 1;
    let before = match index {
        0 if closed && path.period.is_none() => last.saturating_sub(1),
        0 => 0,
        _ => index - 1,
    };
    points[(index + 1).min(last)] - points[before]
}
