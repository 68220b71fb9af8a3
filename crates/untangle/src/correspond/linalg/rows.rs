//! Vectors in whole rows of lanes, padded with zeros.

use crate::simd::{F64_LANES, F64Lanes};

/// As many entries of a vector as go through an operation together.
pub(crate) type Row = [f64; F64_LANES];

/// The scalar product of two vectors: a sum for each lane, then the sum of these.
#[inline(always)]
pub(super) fn dot<L: F64Lanes>(simd: L, a: &[Row], b: &[Row]) -> f64 {
    let mut sums = [0.0; F64_LANES];
    for first in (0..F64_LANES).step_by(L::WIDTH) {
        let mut sum = simd.splat(0.0);
        for (a, b) in a.iter().zip(b) {
            sum = simd.add(sum, simd.mul(simd.load(a, first), simd.load(b, first)));
        }
        simd.store(sum, &mut sums, first);
    }
    sums.iter().sum()
}

/// Adds a multiple of a vector to another one.
#[inline(always)]
pub(super) fn add_scaled<L: F64Lanes>(simd: L, to: &mut [Row], factor: f64, values: &[Row]) {
    let factor = simd.splat(factor);
    for (to, value) in to.iter_mut().zip(values) {
        for first in (0..F64_LANES).step_by(L::WIDTH) {
            let sum = simd.add(simd.load(to, first), simd.mul(factor, simd.load(value, first)));
            simd.store(sum, to, first);
        }
    }
}

/// Replaces a vector by zeros for so many entries.
pub(super) fn clear(rows: &mut Vec<Row>, count: usize) {
    rows.clear();
    rows.resize(count.div_ceil(F64_LANES), [0.0; F64_LANES]);
}
