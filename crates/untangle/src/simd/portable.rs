//! Lanes for any processor: one double, or an array of eight singles that the compiler may vectorise.

use super::lanes::{
    EXPONENT_BIAS, F32_LANES, F32x8Lanes, F64_LANES, F64Lanes, FRACTION, LEAST_MANTISSA, Lanes, TO_LEAST_MANTISSA,
    TWO_TO_52,
};

/// Unit roundoff and underflow threshold of each precision.
pub(super) const F64_ROUNDOFF: f64 = 0.5 * f64::EPSILON;
pub(super) const F64_FLOOR: f64 = 1e-290;
pub(super) const F32_ROUNDOFF: f64 = 0.5 * f32::EPSILON as f64;
pub(super) const F32_FLOOR: f64 = 1e-30;

/// One lane of double precision.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scalar;

impl Lanes for Scalar {
    type Vector = f64;

    const ROUNDOFF: f64 = F64_ROUNDOFF;
    const FLOOR: f64 = F64_FLOOR;

    #[inline(always)]
    fn splat(self, value: f64) -> f64 {
        value
    }

    #[inline(always)]
    fn add(self, a: f64, b: f64) -> f64 {
        a + b
    }

    #[inline(always)]
    fn sub(self, a: f64, b: f64) -> f64 {
        a - b
    }

    #[inline(always)]
    fn mul(self, a: f64, b: f64) -> f64 {
        a * b
    }

    #[inline(always)]
    fn abs(self, a: f64) -> f64 {
        a.abs()
    }

    /// One instruction, where `f64::min` takes several for the sake of NaN.
    #[inline(always)]
    fn min(self, a: f64, b: f64) -> f64 {
        if a < b { a } else { b }
    }

    #[inline(always)]
    fn max(self, a: f64, b: f64) -> f64 {
        if a > b { a } else { b }
    }

    #[inline(always)]
    fn gt_zero_mask(self, a: f64) -> u32 {
        u32::from(a > 0.0)
    }

    #[inline(always)]
    fn select(self, condition: f64, if_positive: f64, otherwise: f64) -> f64 {
        if condition > 0.0 { if_positive } else { otherwise }
    }
}

impl F64Lanes for Scalar {
    const WIDTH: usize = 1;

    #[inline(always)]
    fn div(self, a: f64, b: f64) -> f64 {
        a / b
    }

    #[inline(always)]
    fn sqrt(self, a: f64) -> f64 {
        a.sqrt()
    }

    #[inline(always)]
    fn split(self, a: f64) -> [f64; 2] {
        let shifted = a.to_bits().wrapping_add(TO_LEAST_MANTISSA);
        let exponent = f64::from_bits((shifted >> 52) | TWO_TO_52.to_bits()) - (TWO_TO_52 + EXPONENT_BIAS);
        [exponent, f64::from_bits((shifted & FRACTION) + LEAST_MANTISSA)]
    }

    #[inline(always)]
    fn load(self, row: &[f64; F64_LANES], first: usize) -> f64 {
        row[first]
    }

    #[inline(always)]
    fn store(self, vector: f64, row: &mut [f64; F64_LANES], first: usize) {
        row[first] = vector;
    }
}

/// Eight lanes of single precision in an array.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ArrayF32x8;

#[inline(always)]
fn zip(a: [f32; F32_LANES], b: [f32; F32_LANES], operation: impl Fn(f32, f32) -> f32) -> [f32; F32_LANES] {
    let mut result = a;
    for (result, b) in result.iter_mut().zip(b) {
        *result = operation(*result, b);
    }
    result
}

impl Lanes for ArrayF32x8 {
    type Vector = [f32; F32_LANES];

    const ROUNDOFF: f64 = F32_ROUNDOFF;
    const FLOOR: f64 = F32_FLOOR;

    #[inline(always)]
    fn splat(self, value: f64) -> Self::Vector {
        #[expect(clippy::cast_possible_truncation, reason = "rounded to single precision")]
        let value = value as f32;
        [value; F32_LANES]
    }

    #[inline(always)]
    fn add(self, a: Self::Vector, b: Self::Vector) -> Self::Vector {
        zip(a, b, |a, b| a + b)
    }

    #[inline(always)]
    fn sub(self, a: Self::Vector, b: Self::Vector) -> Self::Vector {
        zip(a, b, |a, b| a - b)
    }

    #[inline(always)]
    fn mul(self, a: Self::Vector, b: Self::Vector) -> Self::Vector {
        zip(a, b, |a, b| a * b)
    }

    #[inline(always)]
    fn abs(self, a: Self::Vector) -> Self::Vector {
        zip(a, a, |a, _| a.abs())
    }

    #[inline(always)]
    fn min(self, a: Self::Vector, b: Self::Vector) -> Self::Vector {
        zip(a, b, |a, b| if a < b { a } else { b })
    }

    #[inline(always)]
    fn max(self, a: Self::Vector, b: Self::Vector) -> Self::Vector {
        zip(a, b, |a, b| if a > b { a } else { b })
    }

    #[inline(always)]
    fn gt_zero_mask(self, a: Self::Vector) -> u32 {
        a.iter().enumerate().fold(0, |mask, (lane, &value)| mask | (u32::from(value > 0.0) << lane))
    }

    #[inline(always)]
    fn select(self, condition: Self::Vector, if_positive: Self::Vector, otherwise: Self::Vector) -> Self::Vector {
        let mut result = otherwise;
        for ((result, condition), if_positive) in result.iter_mut().zip(condition).zip(if_positive) {
            *result = if condition > 0.0 { if_positive } else { *result };
        }
        result
    }
}

impl F32x8Lanes for ArrayF32x8 {
    /// All bits of a lane are set or none, as vector instructions leave it.
    type Mask = [u32; F32_LANES];

    #[inline(always)]
    fn load(self, row: &[f32; F32_LANES]) -> Self::Vector {
        *row
    }

    #[inline(always)]
    fn div(self, a: Self::Vector, b: Self::Vector) -> Self::Vector {
        zip(a, b, |a, b| a / b)
    }

    #[inline(always)]
    fn splat_f32(self, value: f32) -> Self::Vector {
        [value; F32_LANES]
    }

    #[inline(always)]
    fn gather(self, rows: &[[f32; 4]], indices: &[u32; F32_LANES]) -> [Self::Vector; 3] {
        let mut components = [[0.0; F32_LANES]; 3];
        for (lane, &index) in indices.iter().enumerate() {
            for (component, value) in components.iter_mut().zip(rows[index as usize]) {
                component[lane] = value;
            }
        }
        components
    }

    #[inline(always)]
    fn le(self, a: Self::Vector, b: Self::Vector) -> Self::Mask {
        let mut mask = [0; F32_LANES];
        for ((mask, a), b) in mask.iter_mut().zip(a).zip(b) {
            *mask = if a <= b { u32::MAX } else { 0 };
        }
        mask
    }

    #[inline(always)]
    fn and(self, a: Self::Mask, b: Self::Mask) -> Self::Mask {
        let mut mask = a;
        for (mask, b) in mask.iter_mut().zip(b) {
            *mask &= b;
        }
        mask
    }

    #[inline(always)]
    fn mask_bits(self, mask: Self::Mask) -> u32 {
        mask.iter().enumerate().fold(0, |bits, (lane, &all)| bits | (all & (1 << lane)))
    }
}
