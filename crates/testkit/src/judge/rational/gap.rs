//! Squared distances, as fractions.
//!
//! The distance of two convex sets is that of the origin from the convex hull of the differences of their corners. The
//! nearest point of a hull lies within a simplex of some of its corners, and is the nearest point of that simplex'
//! whole span. All simplices of up to three corners are tried: a hull of differences of two segments, or of a point and
//! a triangle, is flat, and each of its points lies in a triangle of its corners.

use super::number::{Fraction, Point, dot, minus};

/// The squared distance of a point and a triangle.
pub(super) fn vertex_squared(vertex: &Point, face: [&Point; 3]) -> Fraction {
    least_squared(&face.map(|corner| minus(vertex, corner)))
}

/// The squared distance of two segments.
pub(super) fn edges_squared(first: [&Point; 2], second: [&Point; 2]) -> Fraction {
    let [[a, b], [c, d]] = [first, second];
    least_squared(&[minus(a, c), minus(a, d), minus(b, c), minus(b, d)])
}

/// The squared distance of the origin from the hull of some points.
fn least_squared(points: &[Point]) -> Fraction {
    let mut least: Option<Fraction> = None;
    let mut offer = |squared: Option<Fraction>| {
        if let Some(squared) = squared
            && least.as_ref().is_none_or(|least| squared < *least)
        {
            least = Some(squared);
        }
    };
    for (i, a) in points.iter().enumerate() {
        offer(Some(dot(a, a)));
        for (k, b) in points.iter().enumerate().skip(i + 1) {
            offer(within_segment(a, b));
            points.iter().skip(k + 1).for_each(|c| offer(within_triangle(a, b, c)));
        }
    }
    least.unwrap()
}

/// The square of the nearest point of a line, where that lies between two points of it.
fn within_segment(a: &Point, b: &Point) -> Option<Fraction> {
    let along = minus(b, a);
    let length = dot(&along, &along);
    if length == Fraction::ZERO {
        return None;
    }
    let part = -dot(a, &along) / length;
    (part > Fraction::ZERO && part < Fraction::ONE).then(|| {
        let nearest: Point = std::array::from_fn(|axis| &a[axis] + &part * &along[axis]);
        dot(&nearest, &nearest)
    })
}

/// The square of the nearest point of a plane, where that lies in the triangle of three points of it.
fn within_triangle(a: &Point, b: &Point, c: &Point) -> Option<Fraction> {
    let (u, v) = (minus(b, a), minus(c, a));
    let (uu, uv, vv) = (dot(&u, &u), dot(&u, &v), dot(&v, &v));
    let determinant = &uu * &vv - &uv * &uv;
    if determinant == Fraction::ZERO {
        return None;
    }
    let (au, av) = (dot(a, &u), dot(a, &v));
    // The normal equations of a + s u + t v.
    let s = (&av * &uv - &au * &vv) / &determinant;
    let t = (&au * &uv - &av * &uu) / determinant;
    (s > Fraction::ZERO && t > Fraction::ZERO && &s + &t < Fraction::ONE).then(|| {
        let nearest: Point = std::array::from_fn(|axis| &a[axis] + &s * &u[axis] + &t * &v[axis]);
        dot(&nearest, &nearest)
    })
}
