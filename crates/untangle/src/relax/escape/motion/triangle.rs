//! Triangles seen along a direction, and the shifts along it at which two of them meet.

use std::cmp::Ordering;

use arrayvec::ArrayVec;
use nalgebra::{Point3, Vector3};

use crate::mesh::{FaceId, Mesh, VertexId};

/// A triangle seen along a direction: two coordinates across, the third along it.
#[derive(Clone, Copy, Debug)]
pub(super) struct SeenTriangle {
    pub(super) face: FaceId,
    pub(super) corners: [Vector3<f64>; 3],
    pub(super) vertices: [VertexId; 3],
    pub(super) low: [f64; 2],
    pub(super) high: [f64; 2],
    /// Its extent along.
    pub(super) near: f64,
    pub(super) far: f64,
    /// Twice the signed area of its shadow.
    area: f64,
}

/// Shifts of the first of two triangles at which they meet.
#[derive(Clone, Copy, Debug)]
pub(super) struct Interval {
    pub(super) least: f64,
    pub(super) most: f64,
}

impl PartialEq for Interval {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Interval {}

impl PartialOrd for Interval {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// By where they begin.
impl Ord for Interval {
    fn cmp(&self, other: &Self) -> Ordering {
        self.least.total_cmp(&other.least).then(self.most.total_cmp(&other.most))
    }
}

/// A point in three axes, the last of them along the direction.
pub(super) fn seen_from(axes: &[Vector3<f64>; 3], point: Point3<f64>) -> Vector3<f64> {
    Vector3::new(axes[0].dot(&point.coords), axes[1].dot(&point.coords), axes[2].dot(&point.coords))
}

impl SeenTriangle {
    pub(super) fn of(mesh: &Mesh, positions: &[Point3<f64>], face: FaceId, axes: &[Vector3<f64>; 3]) -> Self {
        let vertices = mesh.face(face);
        Self::with(face, vertices.map(|vertex| seen_from(axes, positions[vertex.index()])), vertices)
    }

    /// A point as a triangle without a size.
    pub(super) fn point(seen: Vector3<f64>, vertex: VertexId) -> Self {
        Self::with(FaceId(0), [seen; 3], [vertex; 3])
    }

    fn with(face: FaceId, corners: [Vector3<f64>; 3], vertices: [VertexId; 3]) -> Self {
        let [a, b, c] = corners;
        let low = [0, 1].map(|k| a[k].min(b[k]).min(c[k]));
        let high = [0, 1].map(|k| a[k].max(b[k]).max(c[k]));
        let near = a.z.min(b.z).min(c.z);
        let far = a.z.max(b.z).max(c.z);
        Self { face, corners, vertices, low, high, near, far, area: cross(&a, &b, &c) }
    }

    /// The least and the largest shift at which this triangle, moved along, meets another; nothing where their shadows
    /// don't overlap.
    pub(super) fn shifts_to(&self, other: &Self) -> Option<Interval> {
        // The smaller shadow is cut by the larger one, whose depth is known in each point of it.
        let (cut, by, sign) =
            if self.area.abs() <= other.area.abs() { (self, other, 1.0) } else { (other, self, -1.0) };
        if by.area == 0.0 {
            return None;
        }
        let mut polygon = ArrayVec::<Vector3<f64>, 6>::from_iter(cut.corners);
        for k in 0..3 {
            let (a, b) = (by.corners[k], by.corners[(k + 1) % 3]);
            polygon = clipped(&polygon, |point| cross(&a, &b, point) * by.area.signum());
            if polygon.is_empty() {
                return None;
            }
        }
        let mut found = Interval { least: f64::INFINITY, most: f64::NEG_INFINITY };
        for point in &polygon {
            let weights = by.weights_unchecked(point);
            let there: f64 = by.corners.iter().zip(weights).map(|(corner, weight)| corner.z * weight).sum();
            let shift = sign * (there - point.z);
            found = Interval { least: found.least.min(shift), most: found.most.max(shift) };
        }
        Some(found)
    }

    /// Barycentric coordinates of any point of the plane across.
    fn weights_unchecked(&self, point: &Vector3<f64>) -> [f64; 3] {
        let [a, b, c] = &self.corners;
        [cross(b, c, point) / self.area, cross(c, a, point) / self.area, cross(a, b, point) / self.area]
    }

    /// Barycentric coordinates of a point in its shadow.
    pub(super) fn weights_at(&self, point: &Vector3<f64>) -> Option<[f64; 3]> {
        let weights = self.weights_unchecked(point);
        weights.iter().all(|weight| *weight >= 0.0 && *weight <= 1.0).then_some(weights)
    }
}

/// Twice the signed area of the shadow of three points.
fn cross(a: &Vector3<f64>, b: &Vector3<f64>, c: &Vector3<f64>) -> f64 {
    (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)
}

/// The part of a convex polygon where `side` is not negative (Sutherland and Hodgman 1974).
fn clipped(polygon: &[Vector3<f64>], side: impl Fn(&Vector3<f64>) -> f64) -> ArrayVec<Vector3<f64>, 6> {
    let mut kept = ArrayVec::new();
    let Some(mut point) = polygon.last() else { return kept };
    let mut here = side(point);
    for next in polygon {
        let there = side(next);
        if (here > 0.0 && there < 0.0) || (here < 0.0 && there > 0.0) {
            let _ = kept.try_push(point + (next - point) * (here / (here - there)));
        }
        if there >= 0.0 {
            let _ = kept.try_push(*next);
        }
        (point, here) = (next, there);
    }
    kept
}
