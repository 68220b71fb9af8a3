//! The solid angle of a triangle.

use std::f64::consts::PI;

use nalgebra::{Point3, Vector3};

/// The part of a whole sphere that a triangle covers as seen from a point: positive where the point is behind the
/// triangle, whose corners run counter-clockwise seen from in front (Van Oosterom and Strackee 1983). In the plane of
/// the triangle it is 0.
#[inline]
pub(super) fn part_of_sphere(triangle: &[Point3<f64>; 3], at: Point3<f64>) -> f64 {
    let [a, b, c]: [Vector3<f64>; 3] = triangle.map(|corner| corner - at);
    let volume = a.dot(&b.cross(&c));
    if volume == 0.0 {
        return 0.0;
    }
    let lengths = [a, b, c].map(|side| side.norm());
    let denominator =
        lengths[0] * lengths[1] * lengths[2] + a.dot(&b) * lengths[2] + b.dot(&c) * lengths[0] + c.dot(&a) * lengths[1];
    libm::atan2(volume, denominator) / (2.0 * PI)
}
