//! Distances decided in whole numbers.
//!
//! Coordinates and the distance are whole multiples of one power of two. The closest points of two primitives lie in
//! the interior of one of their features each, so that the primitives are nearer than a distance exactly where one of
//! these holds, each a comparison of polynomials without a division:
//!
//! - two corners are nearer;
//! - a corner projects to the interior of an edge, and is nearer to its line;
//! - the vertex projects into the face, and is nearer to its plane;
//! - the common perpendicular of both edges ends within both, and is shorter.

use std::ops::Sub;

use num_bigint::{BigInt, Sign};

use super::vector::Point;

/// A vector with whole coordinates.
#[derive(Clone)]
struct Vector([BigInt; 3]);

impl Vector {
    fn dot(&self, other: &Self) -> BigInt {
        let [x, y, z] = [0, 1, 2].map(|axis| &self.0[axis] * &other.0[axis]);
        x + y + z
    }

    fn squared(&self) -> BigInt {
        self.dot(self)
    }

    fn cross(&self, other: &Self) -> Self {
        let along = |i: usize, k: usize| &self.0[i] * &other.0[k] - &self.0[k] * &other.0[i];
        Self([along(1, 2), along(2, 0), along(0, 1)])
    }
}

impl Sub for &Vector {
    type Output = Vector;

    fn sub(self, other: &Vector) -> Vector {
        Vector([0, 1, 2].map(|axis| &self.0[axis] - &other.0[axis]))
    }
}

/// See [`super::is_vertex_nearer`].
pub(super) fn is_vertex_nearer(vertex: Point, [a, b, c]: [Point; 3], distance: f64) -> bool {
    let ([p, a, b, c], squared) = whole([vertex, a, b, c], distance);
    is_near_edge(&p, [&a, &b], &squared)
        || is_near_edge(&p, [&b, &c], &squared)
        || is_near_edge(&p, [&c, &a], &squared)
        || is_near_interior(&p, [&a, &b, &c], &squared)
}

/// See [`super::are_edges_nearer`].
pub(super) fn are_edges_nearer([a, b]: [Point; 2], [c, d]: [Point; 2], distance: f64) -> bool {
    let ([a, b, c, d], squared) = whole([a, b, c, d], distance);
    is_near_edge(&a, [&c, &d], &squared)
        || is_near_edge(&b, [&c, &d], &squared)
        || is_near_edge(&c, [&a, &b], &squared)
        || is_near_edge(&d, [&a, &b], &squared)
        || are_interiors_near([&a, &b], [&c, &d], &squared)
}

/// Whether a point is nearer to an edge than the root of `squared`.
fn is_near_edge(p: &Vector, [a, b]: [&Vector; 2], squared: &BigInt) -> bool {
    let (along, offset) = (b - a, p - a);
    let own = offset.squared();
    if own < *squared || (p - b).squared() < *squared {
        return true;
    }
    let (length, product) = (along.squared(), offset.dot(&along));
    product.sign() == Sign::Plus && product < length && own * &length - &product * &product < squared * &length
}

/// Whether a point projects into a triangle with an area, and is nearer to its plane than the root of `squared`.
fn is_near_interior(p: &Vector, [a, b, c]: [&Vector; 3], squared: &BigInt) -> bool {
    let normal = (b - a).cross(&(c - a));
    let size = normal.squared();
    let is_inside = |from: &Vector, to: &Vector| (to - from).cross(&(p - from)).dot(&normal).sign() != Sign::Minus;
    if size.sign() == Sign::NoSign || !(is_inside(a, b) && is_inside(b, c) && is_inside(c, a)) {
        return false;
    }
    let height = (p - a).dot(&normal);
    &height * &height < squared * size
}

/// Whether the common perpendicular of two edges that are not parallel ends within both, and is shorter than the root
/// of `squared`.
fn are_interiors_near([a, b]: [&Vector; 2], [c, d]: [&Vector; 2], squared: &BigInt) -> bool {
    let (u, v, w) = (b - a, d - c, a - c);
    let normal = u.cross(&v);
    let size = normal.squared();
    if size.sign() == Sign::NoSign {
        return false;
    }
    let (uu, uv, vv, uw, vw) = (u.squared(), u.dot(&v), v.squared(), u.dot(&w), v.dot(&w));
    // Both parameters times the size of the normal.
    let parameters = [&uv * &vw - &vv * &uw, &uu * &vw - &uv * &uw];
    if parameters.iter().any(|parameter| parameter.sign() == Sign::Minus || *parameter > size) {
        return false;
    }
    let height = w.dot(&normal);
    &height * &height < squared * size
}

/// Points, and the square of a distance, as whole multiples of one power of two and its square.
fn whole<const N: usize>(points: [Point; N], distance: f64) -> ([Vector; N], BigInt) {
    let values = points.iter().flatten().chain([&distance]);
    let least = values.filter(|value| value.abs() > 0.0).map(|&value| parts(value).1).min().unwrap_or(0);
    let number = |value: f64| {
        let (mantissa, exponent) = parts(value);
        let shift = usize::try_from(exponent - least).unwrap_or(0);
        BigInt::from(mantissa) << shift
    };
    let distance = number(distance);
    (points.map(|point| Vector(point.map(number))), &distance * &distance)
}

/// A finite number as a whole number times a power of two.
fn parts(value: f64) -> (i64, i32) {
    let bits = value.to_bits();
    let (fraction, biased) = (bits & ((1 << 52) - 1), (bits >> 52) & 0x7ff);
    #[expect(clippy::cast_possible_truncation, reason = "eleven bits")]
    let exponent = biased.max(1) as i32 - 1075;
    let magnitude = if biased == 0 { fraction } else { fraction | 1 << 52 };
    let mantissa = i64::try_from(magnitude).unwrap_or_default();
    (if value < 0.0 { -mantissa } else { mantissa }, exponent)
}
