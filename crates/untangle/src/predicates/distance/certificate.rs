//! Proofs in floating point that the origin is nearer to the hull of some differences than a distance, or is not.
//!
//! - *Nearer*: weights that are not negative name a point of the hull, and that point is nearer.
//! - *Not nearer*: a direction along which all differences reach at least the distance.
//!
//! Both hold for any weights and any direction; those of the closest points make them sharp.

use super::vector::{Point, dot};

/// Error bound, relative to the sums of magnitudes. With `u = 2^-53`: a difference of coordinates is off by `u` of
/// itself. A weighted sum of up to four of them adds four roundings, and its length three: at most `13 u` of the length
/// of the sum of magnitudes, the rounding of that included. The scalar product with a direction, three terms, is off
/// by at most `6 u` of its sum of magnitudes. Sums of weights, and the product with the distance, by `4 u`. Each
/// comparison below leaves at least twice its own error: `32 u`.
const ERROR: f64 = 32.0 * (0.5 * f64::EPSILON);

/// More than all that underflows in either proof: a product by 2^-1075 at most, and the root of a sum of squares that
/// underflow by 2^-536.
const UNDERFLOW: f64 = f64::from_bits((1023 - 500) << 52);

/// Whether the origin is nearer to the hull than `distance`; nothing where neither is proved. Weights are not negative.
///
/// Overflow makes a side of the comparisons infinite or NaN, and proves nothing.
#[inline]
pub(super) fn decide<const N: usize>(differences: &[Point; N], weights: [f64; N], distance: f64) -> Option<bool> {
    let (mut point, mut magnitudes, mut sum) = ([0.0; 3], [0.0; 3], 0.0);
    for (difference, weight) in differences.iter().zip(weights) {
        for axis in 0..3 {
            point[axis] += weight * difference[axis];
            magnitudes[axis] += weight * difference[axis].abs();
        }
        sum += weight;
    }
    let length = dot(point, point).sqrt();
    if length + ERROR * dot(magnitudes, magnitudes).sqrt() + UNDERFLOW < distance * sum * (1.0 - ERROR) {
        return Some(true);
    }
    is_apart_along(differences, point, length, distance).then_some(false)
}

/// Whether the direction between the middles of both primitives proves that they are not nearer: far cheaper than their
/// closest points, and enough for most neighbours on the surface.
#[inline]
pub(super) fn are_middles_apart<const N: usize>(differences: &[Point; N], distance: f64) -> bool {
    let mut sum = [0.0; 3];
    for difference in differences {
        for axis in 0..3 {
            sum[axis] += difference[axis];
        }
    }
    is_apart_along(differences, sum, dot(sum, sum).sqrt(), distance)
}

/// Whether all differences reach at least a distance along a direction of some length.
#[inline]
fn is_apart_along<const N: usize>(differences: &[Point; N], direction: Point, length: f64, distance: f64) -> bool {
    let mut least = f64::INFINITY;
    for difference in differences {
        let terms = [direction[0] * difference[0], direction[1] * difference[1], direction[2] * difference[2]];
        let along = terms[0] + terms[1] + terms[2];
        let reach = along - ERROR * (terms[0].abs() + terms[1].abs() + terms[2].abs());
        // A NaN proves nothing.
        least = if reach >= least { least } else { reach };
    }
    // The length of a direction may have underflowed: times a large distance that is more than the last term.
    let needed = distance * (length + UNDERFLOW) * (1.0 + ERROR) + UNDERFLOW;
    least >= needed && least.is_finite()
}

/// The length of the weighted mean of the differences.
pub(super) fn distance<const N: usize>(differences: &[Point; N], weights: [f64; N]) -> f64 {
    let (mut point, mut sum) = ([0.0; 3], 0.0);
    for (difference, weight) in differences.iter().zip(weights) {
        for axis in 0..3 {
            point[axis] += weight * difference[axis];
        }
        sum += weight;
    }
    // Scaled first, so that no square over- or underflows.
    let largest = point.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
    if largest <= 0.0 {
        return 0.0;
    }
    let scaled = point.map(|value| value / largest);
    largest * dot(scaled, scaled).sqrt() / sum
}
