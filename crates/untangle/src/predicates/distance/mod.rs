//! Whether two primitives are nearer to each other than a distance, exactly: a vertex and a face, an edge and an edge.
//!
//! All are closed convex sets: faces without an area and edges without a length are ordinary. Their distance is that of
//! the origin from the convex hull of all differences of a corner of the one and a corner of the other (Minkowski
//! difference; Gilbert, Johnson and Keerthi 1988). So one filter serves both kinds: [`certificate`] proves an answer in
//! floating point from the weights of the closest points, whatever rounding did to these. What it leaves open, ties
//! among it, is decided in whole numbers ([`exact`]). There is no perturbation: two primitives at exactly the distance
//! are not nearer.
//!
//! | file | purpose |
//! |---|---|
//! | `vector` | vectors of doubles |
//! | `closest` | closest points in floating point, without any promise |
//! | `certificate` | proofs of "nearer" and "not nearer" from them |
//! | `exact` | the answer in whole numbers |

mod certificate;
mod closest;
mod exact;
#[cfg(test)]
mod tests;
mod vector;

pub(crate) use closest::{edge_edge_weights, vertex_face_weights};

use certificate::{are_middles_apart, decide};
use vector::{Point, difference};

/// Whether the distance of a point and a triangle is less than `distance_m`, which is taken as it is, to the bit. Two
/// in one place are at distance zero.
///
/// Cost: some hundred floating-point operations nearly always; tens of microseconds near ties.
#[must_use]
pub fn is_vertex_nearer(vertex: Point, face: [Point; 3], distance_m: f64) -> bool {
    vertex_distance_below(vertex, face, distance_m).is_some()
}

/// Whether the distance of two segments is less than `distance_m`; see [`is_vertex_nearer`].
#[must_use]
pub fn are_edges_nearer(first: [Point; 2], second: [Point; 2], distance_m: f64) -> bool {
    edge_distance_below(first, second, distance_m).is_some()
}

/// The rounded distance of a point and a triangle, if it is less than `below_m`; see [`is_vertex_nearer`].
pub(crate) fn vertex_distance_below(vertex: Point, face: [Point; 3], below_m: f64) -> Option<f64> {
    let differences = face.map(|corner| difference(vertex, corner));
    if are_middles_apart(&differences, below_m) {
        return None;
    }
    let weights = vertex_face_weights(vertex, face);
    let is_below = decide(&differences, weights, below_m);
    is_below.unwrap_or_else(|| exact::is_vertex_nearer(vertex, face, below_m)).then(|| {
        let unit = unit(&differences);
        // Whole powers of two change no weight but where something under- or overflows.
        let weights =
            if unit.to_bits() == 1f64.to_bits() { weights } else { scaled_vertex_face_weights(vertex, face, unit) };
        certificate::distance(&differences, weights)
    })
}

/// The rounded distance of two segments, if it is less than `below_m`; see [`is_vertex_nearer`].
pub(crate) fn edge_distance_below(first: [Point; 2], second: [Point; 2], below_m: f64) -> Option<f64> {
    let differences = edge_differences(first, second);
    if are_middles_apart(&differences, below_m) {
        return None;
    }
    let weights = edge_weights(first, second);
    let is_below = decide(&differences, weights, below_m);
    is_below.unwrap_or_else(|| exact::are_edges_nearer(first, second, below_m)).then(|| {
        let unit = unit(&differences);
        let weights = if unit.to_bits() == 1f64.to_bits() { weights } else { scaled_edge_weights(first, second, unit) };
        certificate::distance(&differences, weights)
    })
}

/// The distance of a point and a triangle, in metres, rounded: off by some units in the last place of the largest
/// difference of coordinates, and for faces of next to no area by up to 1e-6 of that.
pub(crate) fn vertex_face_distance(vertex: Point, face: [Point; 3]) -> f64 {
    let differences = face.map(|corner| difference(vertex, corner));
    certificate::distance(&differences, scaled_vertex_face_weights(vertex, face, unit(&differences)))
}

/// The distance of two segments, in metres, rounded in the same way; up to 1e-6 where they are nearly parallel.
pub(crate) fn edge_edge_distance(first: [Point; 2], second: [Point; 2]) -> f64 {
    let differences = edge_differences(first, second);
    certificate::distance(&differences, scaled_edge_weights(first, second, unit(&differences)))
}

fn scaled_vertex_face_weights(vertex: Point, face: [Point; 3], unit: f64) -> [f64; 3] {
    vertex_face_weights(scaled(vertex, unit), face.map(|corner| scaled(corner, unit)))
}

fn scaled_edge_weights(first: [Point; 2], second: [Point; 2], unit: f64) -> [f64; 4] {
    edge_weights(first.map(|end| scaled(end, unit)), second.map(|end| scaled(end, unit)))
}

/// A power of two by which products of four lengths neither under- nor overflow; nearly always 1.
fn unit(differences: &[Point]) -> f64 {
    let largest = differences.iter().flatten().fold(0.0, |largest: f64, value| largest.max(value.abs()));
    if largest <= 0.0 || (1e-30..1e30).contains(&largest) {
        return 1.0;
    }
    // The exponent alone, turned round.
    f64::from_bits((2046 << 52) - (largest.to_bits() & (0x7ff << 52)))
}

fn scaled(point: Point, unit: f64) -> Point {
    point.map(|value| value * unit)
}

fn edge_differences([a, b]: [Point; 2], [c, d]: [Point; 2]) -> [Point; 4] {
    [difference(a, c), difference(a, d), difference(b, c), difference(b, d)]
}

fn edge_weights(first: [Point; 2], second: [Point; 2]) -> [f64; 4] {
    let [[a, b], [c, d]] = edge_edge_weights(first, second);
    [a * c, a * d, b * c, b * d]
}
