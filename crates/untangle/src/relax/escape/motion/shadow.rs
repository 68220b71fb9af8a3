//! How far one sheet has to be moved along a direction until it has left another: seen along that direction, a pair of
//! triangles whose shadows overlap meets for an interval of shifts.

use std::{cmp::Reverse, collections::BinaryHeap};

use nalgebra::{Point3, Vector3};

use super::{
    grid::Grid,
    triangle::{Interval, SeenTriangle, seen_from},
};
use crate::{
    intersect::{Intersections, Segment},
    mesh::{FaceId, Mesh, VertexId},
};

/// Two sheets seen along a direction.
#[derive(Debug, Default)]
pub(crate) struct Shadow {
    sheets: [Vec<SeenTriangle>; 2],
    grid: Grid,
    pairs: Vec<Pair>,
    intervals: BinaryHeap<Reverse<Interval>>,
    axes: [Vector3<f64>; 3],
    /// Faces with a common vertex that intersect, in both orders, ascending.
    hinged: Vec<[FaceId; 2]>,
}

/// Two triangles, one of each sheet, whose shadows may overlap. Where they meet, the shift is from `least` to `most`,
/// but for rounding.
#[derive(Clone, Copy, Debug)]
struct Pair {
    least: f64,
    most: f64,
    first: u32,
    second: u32,
}

/// A point of a sheet, with the shift that takes it to a point of the other.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Meeting {
    pub(crate) shift_m: f64,
    pub(crate) corners: [VertexId; 3],
    pub(crate) weights: [f64; 3],
}

impl Shadow {
    /// Takes the pairs of faces with a common vertex that intersect: the only ones of such pairs that count as meeting.
    pub(crate) fn set_hinged(&mut self, mesh: &Mesh, found: &Intersections) {
        self.hinged.clear();
        for &Segment { faces: [a, b], .. } in &found.segments {
            if mesh.face(a).iter().any(|vertex| mesh.face(b).contains(vertex)) {
                self.hinged.extend([[a, b], [b, a]]);
            }
        }
        self.hinged.sort_unstable();
    }

    /// Looks at two sheets along a unit direction.
    pub(crate) fn look(&mut self, mesh: &Mesh, positions: &[Point3<f64>], faces: [&[FaceId]; 2], along: Vector3<f64>) {
        let helper = if along.x.abs() < 0.6 { Vector3::x() } else { Vector3::y() };
        let across = along.cross(&helper).normalize();
        self.axes = [across, along.cross(&across), along];
        let axes = self.axes;
        for (seen, faces) in self.sheets.iter_mut().zip(faces) {
            seen.clear();
            seen.extend(faces.iter().map(|&face| SeenTriangle::of(mesh, positions, face, &axes)));
        }
        self.grid.fill(&self.sheets[1]);
    }

    /// The distance that the first sheet has to be moved until it has left the second, in metres: the end of the run of
    /// shifts, from zero on, at which they meet. Ends early where it is more than `limit_m`.
    pub(crate) fn depth_m(&mut self, limit_m: f64) -> f64 {
        self.find_pairs(limit_m);
        let Self { sheets: [first, second], pairs, intervals, .. } = self;
        intervals.clear();
        let mut pairs = pairs.iter().peekable();
        let mut depth = 0.0;
        while depth <= limit_m {
            // Intervals in the order of their ends: one that is known waits for pairs whose interval may begin before.
            if let Some(&&pair) = pairs.peek()
                && intervals.peek().is_none_or(|Reverse(interval)| pair.least <= interval.least)
            {
                if pair.least > depth {
                    break;
                }
                pairs.next();
                // Most pairs are behind what is known, and their triangles need not be cut by each other.
                if pair.most > depth
                    && let Some(interval) = first[pair.first as usize].shifts_to(&second[pair.second as usize])
                    && interval.most > 0.0
                {
                    intervals.push(Reverse(interval));
                }
            } else {
                match intervals.pop() {
                    Some(Reverse(interval)) if interval.least <= depth => depth = interval.most.max(depth),
                    _ => break,
                }
            }
        }
        depth
    }

    /// Pairs of triangles that may meet at a shift from zero to `limit_m`, by the least one.
    fn find_pairs(&mut self, limit_m: f64) {
        let Self { sheets: [first, second], grid, pairs, hinged, .. } = self;
        pairs.clear();
        if second.is_empty() {
            return;
        }
        for (number, triangle) in (0u32..).zip(first.iter()) {
            grid.visit(triangle, |member, cell| {
                let other = &second[member as usize];
                let overlap = |k: usize| triangle.low[k] <= other.high[k] && other.low[k] <= triangle.high[k];
                let is_first_cell = || grid.cell_of([0, 1].map(|k| triangle.low[k].max(other.low[k]))) == cell;
                let (least, most) = (other.near - triangle.far, other.far - triangle.near);
                if overlap(0)
                    && overlap(1)
                    && most > 0.0
                    && least <= limit_m
                    && is_first_cell()
                    && (triangle.vertices.iter().all(|vertex| !other.vertices.contains(vertex))
                        || hinged.binary_search(&[triangle.face, other.face]).is_ok())
                {
                    pairs.push(Pair { least, most, first: number, second: member });
                }
            });
        }
        pairs.sort_unstable_by(|a, b| a.least.total_cmp(&b.least).then((a.first, a.second).cmp(&(b.first, b.second))));
    }

    /// The meeting farthest ahead, but not beyond `depth_m`, of a point of the first sheet with the second one.
    pub(crate) fn farthest_meeting(&self, point: Point3<f64>, vertex: VertexId, depth_m: f64) -> Option<Meeting> {
        let seen = seen_from(&self.axes, point);
        let mut farthest: Option<Meeting> = None;
        let place = SeenTriangle::point(seen, vertex);
        self.grid.visit(&place, |member, _| {
            let other = &self.sheets[1][member as usize];
            if other.vertices.contains(&vertex) {
                return;
            }
            let Some(weights) = other.weights_at(&seen) else { return };
            let there: f64 = other.corners.iter().zip(weights).map(|(corner, weight)| corner.z * weight).sum();
            let shift_m = there - seen.z;
            if shift_m > 0.0 && shift_m <= depth_m && farthest.is_none_or(|found| shift_m > found.shift_m) {
                farthest = Some(Meeting { shift_m, corners: other.vertices, weights });
            }
        });
        farthest
    }
}
