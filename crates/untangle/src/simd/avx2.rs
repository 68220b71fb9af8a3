//! Lanes of the x86-64-v3 instruction set (AVX2): four doubles or eight singles to a register.

use pulp::{f32x8, f64x4, u32x8, x86::V3};

use super::{
    lanes::{
        EXPONENT_BIAS, F32_LANES, F32x8Lanes, F64_LANES, F64Lanes, FRACTION, LEAST_MANTISSA, Lanes, TO_LEAST_MANTISSA,
        TWO_TO_52,
    },
    portable::{F32_FLOOR, F32_ROUNDOFF, F64_FLOOR, F64_ROUNDOFF},
};

/// Four lanes of double precision.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Avx2F64x4(pub(super) V3);

impl Lanes for Avx2F64x4 {
    type Vector = f64x4;

    const ROUNDOFF: f64 = F64_ROUNDOFF;
    const FLOOR: f64 = F64_FLOOR;

    #[inline(always)]
    fn splat(self, value: f64) -> f64x4 {
        self.0.splat_f64x4(value)
    }

    #[inline(always)]
    fn add(self, a: f64x4, b: f64x4) -> f64x4 {
        self.0.add_f64x4(a, b)
    }

    #[inline(always)]
    fn sub(self, a: f64x4, b: f64x4) -> f64x4 {
        self.0.sub_f64x4(a, b)
    }

    #[inline(always)]
    fn mul(self, a: f64x4, b: f64x4) -> f64x4 {
        self.0.mul_f64x4(a, b)
    }

    #[inline(always)]
    fn abs(self, a: f64x4) -> f64x4 {
        self.0.abs_f64x4(a)
    }

    #[inline(always)]
    fn min(self, a: f64x4, b: f64x4) -> f64x4 {
        self.0.min_f64x4(a, b)
    }

    #[inline(always)]
    fn max(self, a: f64x4, b: f64x4) -> f64x4 {
        self.0.max_f64x4(a, b)
    }

    #[inline(always)]
    fn gt_zero_mask(self, a: f64x4) -> u32 {
        let is_positive = self.0.cmp_gt_f64x4(a, self.0.splat_f64x4(0.0));
        self.0.avx._mm256_movemask_pd(pulp::cast(is_positive)).cast_unsigned()
    }

    #[inline(always)]
    fn select(self, condition: f64x4, if_positive: f64x4, otherwise: f64x4) -> f64x4 {
        self.0.select_f64x4(self.0.cmp_gt_f64x4(condition, self.0.splat_f64x4(0.0)), if_positive, otherwise)
    }
}

impl F64Lanes for Avx2F64x4 {
    const WIDTH: usize = F64_LANES;

    #[inline(always)]
    fn div(self, a: f64x4, b: f64x4) -> f64x4 {
        self.0.div_f64x4(a, b)
    }

    #[inline(always)]
    fn sqrt(self, a: f64x4) -> f64x4 {
        self.0.sqrt_f64x4(a)
    }

    #[inline(always)]
    fn split(self, a: f64x4) -> [f64x4; 2] {
        let V3 { avx, avx2, .. } = self.0;
        let splat = |bits: u64| avx._mm256_set1_epi64x(bits.cast_signed());
        let shifted = avx2._mm256_add_epi64(pulp::cast(a), splat(TO_LEAST_MANTISSA));
        let exponent = avx2._mm256_or_si256(avx2._mm256_srli_epi64::<52>(shifted), splat(TWO_TO_52.to_bits()));
        let fraction = avx2._mm256_and_si256(shifted, splat(FRACTION));
        let mantissa = avx2._mm256_add_epi64(fraction, splat(LEAST_MANTISSA));
        [self.sub(pulp::cast(exponent), self.splat(TWO_TO_52 + EXPONENT_BIAS)), pulp::cast(mantissa)]
    }

    #[inline(always)]
    fn load(self, row: &[f64; F64_LANES], _: usize) -> f64x4 {
        pulp::cast(*row)
    }

    #[inline(always)]
    fn store(self, vector: f64x4, row: &mut [f64; F64_LANES], _: usize) {
        *row = pulp::cast(vector);
    }
}

/// Eight lanes of single precision.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Avx2F32x8(pub(super) V3);

impl Lanes for Avx2F32x8 {
    type Vector = f32x8;

    const ROUNDOFF: f64 = F32_ROUNDOFF;
    const FLOOR: f64 = F32_FLOOR;

    #[inline(always)]
    fn splat(self, value: f64) -> f32x8 {
        #[expect(clippy::cast_possible_truncation, reason = "rounded to single precision")]
        self.0.splat_f32x8(value as f32)
    }

    #[inline(always)]
    fn add(self, a: f32x8, b: f32x8) -> f32x8 {
        self.0.add_f32x8(a, b)
    }

    #[inline(always)]
    fn sub(self, a: f32x8, b: f32x8) -> f32x8 {
        self.0.sub_f32x8(a, b)
    }

    #[inline(always)]
    fn mul(self, a: f32x8, b: f32x8) -> f32x8 {
        self.0.mul_f32x8(a, b)
    }

    #[inline(always)]
    fn abs(self, a: f32x8) -> f32x8 {
        self.0.abs_f32x8(a)
    }

    #[inline(always)]
    fn min(self, a: f32x8, b: f32x8) -> f32x8 {
        self.0.min_f32x8(a, b)
    }

    #[inline(always)]
    fn max(self, a: f32x8, b: f32x8) -> f32x8 {
        self.0.max_f32x8(a, b)
    }

    #[inline(always)]
    fn gt_zero_mask(self, a: f32x8) -> u32 {
        self.mask_bits(pulp::cast(self.0.cmp_gt_f32x8(a, self.0.splat_f32x8(0.0))))
    }

    #[inline(always)]
    fn select(self, condition: f32x8, if_positive: f32x8, otherwise: f32x8) -> f32x8 {
        self.0.select_f32x8(self.0.cmp_gt_f32x8(condition, self.0.splat_f32x8(0.0)), if_positive, otherwise)
    }
}

impl F32x8Lanes for Avx2F32x8 {
    type Mask = u32x8;

    #[inline(always)]
    fn load(self, row: &[f32; F32_LANES]) -> f32x8 {
        pulp::cast(*row)
    }

    #[inline(always)]
    fn div(self, a: f32x8, b: f32x8) -> f32x8 {
        self.0.div_f32x8(a, b)
    }

    #[inline(always)]
    fn splat_f32(self, value: f32) -> f32x8 {
        self.0.splat_f32x8(value)
    }

    /// A row is one load; four by four the rows are transposed.
    #[inline(always)]
    fn gather(self, rows: &[[f32; 4]], at: &[u32; F32_LANES]) -> [f32x8; 3] {
        let avx = self.0.avx;
        let a = two_rows(rows, at[0], at[4]);
        let b = two_rows(rows, at[1], at[5]);
        let c = two_rows(rows, at[2], at[6]);
        let d = two_rows(rows, at[3], at[7]);
        let (low, high) = (avx._mm256_unpacklo_ps(a, b), avx._mm256_unpacklo_ps(c, d));
        let x = avx._mm256_shuffle_ps::<0b01_00_01_00>(low, high);
        let y = avx._mm256_shuffle_ps::<0b11_10_11_10>(low, high);
        let (low, high) = (avx._mm256_unpackhi_ps(a, b), avx._mm256_unpackhi_ps(c, d));
        let z = avx._mm256_shuffle_ps::<0b01_00_01_00>(low, high);
        [pulp::cast(x), pulp::cast(y), pulp::cast(z)]
    }

    #[inline(always)]
    fn le(self, a: f32x8, b: f32x8) -> u32x8 {
        pulp::cast(self.0.cmp_le_f32x8(a, b))
    }

    #[inline(always)]
    fn and(self, a: u32x8, b: u32x8) -> u32x8 {
        self.0.and_u32x8(a, b)
    }

    #[inline(always)]
    fn mask_bits(self, mask: u32x8) -> u32 {
        self.0.avx._mm256_movemask_ps(pulp::cast(mask)).cast_unsigned()
    }
}

/// Two rows in the halves of one register.
#[inline(always)]
fn two_rows(rows: &[[f32; 4]], first: u32, second: u32) -> std::arch::x86_64::__m256 {
    pulp::cast([rows[first as usize], rows[second as usize]])
}
