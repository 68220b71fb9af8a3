//! Closest points in floating point (Ericson 2004, sections 5.1.5 and 5.1.9).
//!
//! Weights are never negative and never NaN, and at least one is positive. Rounding may lead to points that are not the
//! closest ones, which the certificates find out; but not by more than some 1e-6 of the largest difference of
//! coordinates: where faces are thin, or edges nearly parallel, all ways are tried and the shortest is taken.

use super::vector::{Point, difference, dot};

/// The weights of a triangle's corners in the point that is closest to a vertex.
#[inline]
pub(crate) fn vertex_face_weights(p: Point, [a, b, c]: [Point; 3]) -> [f64; 3] {
    let (ab, ac, ap) = (difference(b, a), difference(c, a), difference(p, a));
    let (d1, d2) = (dot(ab, ap), dot(ac, ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    let bp = difference(p, b);
    let (d3, d4) = (dot(ab, bp), dot(ac, bp));
    if d3 >= 0.0 && d4 <= d3 {
        return [0.0, 1.0, 0.0];
    }
    let cp = difference(p, c);
    let (d5, d6) = (dot(ab, cp), dot(ac, cp));
    if d6 >= 0.0 && d5 <= d6 {
        return [0.0, 0.0, 1.0];
    }
    let [vc, vb, va] = [d1 * d4 - d3 * d2, d5 * d2 - d1 * d6, d3 * d6 - d5 * d4];
    let inside = inside([va, vb, vc]);
    if are_thin(dot(ab, ab), dot(ac, ac), dot(ab, ac)) {
        return shortest(&[ap, bp, cp].map(|way| way.map(|value| -value)), inside);
    }
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let [first, second] = share(-d3, d1);
        return [first, second, 0.0];
    }
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let [first, second] = share(-d6, d2);
        return [first, 0.0, second];
    }
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        let [first, second] = share(d5 - d6, d4 - d3);
        return [0.0, first, second];
    }
    inside
}

/// The weights of a point inside of a triangle, in a proportion; those of a corner where there is none.
#[inline]
fn inside(weights: [f64; 3]) -> [f64; 3] {
    let weights = weights.map(|weight| if weight > 0.0 { weight } else { 0.0 });
    let sum = weights[0] + weights[1] + weights[2];
    if sum > 0.0 && sum.is_finite() { weights.map(|weight| weight / sum) } else { [1.0, 0.0, 0.0] }
}

/// Whether the height of two sides over the longer one, by their squared lengths and their product, is so little beside
/// it that rounding decides where closest points lie.
#[inline]
fn are_thin(first: f64, second: f64, product: f64) -> bool {
    let longer = if first > second { first } else { second };
    // Where a length is zero, or something overflows, they are not thick.
    let are_thick = first * second - product * product > THIN * (longer * longer);
    !are_thick
}

/// The square of a thousandth.
const THIN: f64 = 1e-6;

/// Of a way to a point inside and those to the sides of a triangle, all from the origin, the weights of the shortest.
fn shortest(corners: &[Point; 3], inside: [f64; 3]) -> [f64; 3] {
    let squared = |weights: [f64; 3]| {
        let way: Point = std::array::from_fn(|axis| (0..3).map(|corner| weights[corner] * corners[corner][axis]).sum());
        dot(way, way)
    };
    let mut best = (squared(inside), inside);
    for corner in 0..3 {
        let next = (corner + 1) % 3;
        let along = difference(corners[next], corners[corner]);
        let part = limit(-dot(corners[corner], along) / dot(along, along));
        let mut weights = [0.0; 3];
        (weights[corner], weights[next]) = (1.0 - part, part);
        let way = squared(weights);
        if way < best.0 {
            best = (way, weights);
        }
    }
    best.1
}

/// Two weights that sum to one, in a proportion.
#[inline]
fn share(first: f64, second: f64) -> [f64; 2] {
    let second = limit(second / (first + second));
    [1.0 - second, second]
}

/// The nearest number from 0 to 1; 0 for NaN.
#[inline]
fn limit(value: f64) -> f64 {
    if value > 0.0 { value.min(1.0) } else { 0.0 }
}

/// The weights of the ends of two segments in the points that are closest to each other.
#[inline]
pub(crate) fn edge_edge_weights([p1, q1]: [Point; 2], [p2, q2]: [Point; 2]) -> [[f64; 2]; 2] {
    let (d1, d2, r) = (difference(q1, p1), difference(q2, p2), difference(p1, p2));
    let (a, e, f) = (dot(d1, d1), dot(d2, d2), dot(d2, r));
    let weights = |s: f64, t: f64| [[1.0 - s, s], [1.0 - t, t]];
    if a <= 0.0 {
        return weights(0.0, limit(f / e));
    }
    let c = dot(d1, r);
    if e <= 0.0 {
        return weights(limit(-c / a), 0.0);
    }
    let b = dot(d1, d2);
    let denominator = a * e - b * b;
    let s = if denominator > 0.0 { limit((b * f - c * e) / denominator) } else { 0.0 };
    let t = (b * s + f) / e;
    let found = if t < 0.0 {
        weights(limit(-c / a), 0.0)
    } else if t > 1.0 {
        weights(limit((b - c) / a), 1.0)
    } else {
        // Of nearly parallel segments the first parameter is noise: that for the second one is better.
        let t = limit(t);
        weights(limit((b * t - c) / a), t)
    };
    if denominator > 0.0 && are_thin(a, e, b) {
        // From each end as well.
        let ends = [[0.0, limit(f / e)], [1.0, limit((b + f) / e)], [limit(-c / a), 0.0], [limit((b - c) / a), 1.0]];
        let squared = |[[_, s], [_, t]]: [[f64; 2]; 2]| {
            let way: Point = std::array::from_fn(|axis| r[axis] + s * d1[axis] - t * d2[axis]);
            dot(way, way)
        };
        let all = ends.map(|[s, t]| weights(s, t)).into_iter();
        return all.fold(found, |best, other| if squared(other) < squared(best) { other } else { best });
    }
    found
}
