//! Eight numbers of single precision at a time.

use super::{arithmetic::Arithmetic, boxes::WIDTH, lanes::Portable};

/// Points in single precision; the fourth number is of no meaning, and makes a point one load.
pub(crate) type Mapped = [f32; 4];

/// Mapped coordinates are at most one half, and so far at most from where a map without rounding would take them: twice what rounding to a
/// single number does.
pub(crate) const MAPPED_ERROR: f64 = 0.25 * f32::EPSILON as f64;

/// Arithmetic with eight numbers side by side.
pub(crate) trait Eights: Arithmetic {
    /// Eight of some points, coordinate by coordinate.
    fn gather(self, points: &[Mapped], at: &[u32; WIDTH]) -> [Self::Value; 3];
}

/// Eight numbers of single precision, by the means of `L`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Singles<L>(pub(crate) L);

const ROUNDOFF: f64 = 0.5 * f32::EPSILON as f64;
const FLOOR: f64 = 1e-30;

#[inline(always)]
fn each(a: [f32; WIDTH], b: [f32; WIDTH], of: impl Fn(f32, f32) -> f32) -> [f32; WIDTH] {
    let mut result = a;
    for (result, b) in result.iter_mut().zip(b) {
        *result = of(*result, b);
    }
    result
}

#[expect(clippy::cast_possible_truncation, reason = "numbers of single precision are asked for")]
impl Arithmetic for Singles<Portable> {
    type Value = [f32; WIDTH];

    const ROUNDOFF: f64 = ROUNDOFF;
    const FLOOR: f64 = FLOOR;

    #[inline(always)]
    fn of(self, value: f64) -> Self::Value {
        [value as f32; WIDTH]
    }

    #[inline(always)]
    fn sum(self, a: Self::Value, b: Self::Value) -> Self::Value {
        each(a, b, |a, b| a + b)
    }

    #[inline(always)]
    fn difference(self, a: Self::Value, b: Self::Value) -> Self::Value {
        each(a, b, |a, b| a - b)
    }

    #[inline(always)]
    fn product(self, a: Self::Value, b: Self::Value) -> Self::Value {
        each(a, b, |a, b| a * b)
    }

    #[inline(always)]
    fn magnitude(self, a: Self::Value) -> Self::Value {
        each(a, a, |a, _| a.abs())
    }

    #[inline(always)]
    fn lower(self, a: Self::Value, b: Self::Value) -> Self::Value {
        each(a, b, |a, b| if a < b { a } else { b })
    }

    #[inline(always)]
    fn higher(self, a: Self::Value, b: Self::Value) -> Self::Value {
        each(a, b, |a, b| if a > b { a } else { b })
    }

    #[inline(always)]
    fn positive(self, a: Self::Value) -> u32 {
        a.iter().enumerate().fold(0, |mask, (lane, &value)| mask | (u32::from(value > 0.0) << lane))
    }

    #[inline(always)]
    fn choose(self, condition: Self::Value, yes: Self::Value, no: Self::Value) -> Self::Value {
        let mut result = no;
        for ((result, condition), yes) in result.iter_mut().zip(condition).zip(yes) {
            *result = if condition > 0.0 { yes } else { *result };
        }
        result
    }
}

impl Eights for Singles<Portable> {
    #[inline(always)]
    fn gather(self, points: &[Mapped], at: &[u32; WIDTH]) -> [Self::Value; 3] {
        let mut rows = [[0.0; WIDTH]; 3];
        for (lane, &at) in at.iter().enumerate() {
            let point = points[at as usize];
            for (row, coordinate) in rows.iter_mut().zip(point) {
                row[lane] = coordinate;
            }
        }
        rows
    }
}

#[cfg(target_arch = "x86_64")]
#[expect(clippy::cast_possible_truncation, reason = "numbers of single precision are asked for")]
impl Arithmetic for Singles<pulp::x86::V3> {
    type Value = pulp::f32x8;

    const ROUNDOFF: f64 = ROUNDOFF;
    const FLOOR: f64 = FLOOR;

    #[inline(always)]
    fn of(self, value: f64) -> pulp::f32x8 {
        self.0.splat_f32x8(value as f32)
    }

    #[inline(always)]
    fn sum(self, a: pulp::f32x8, b: pulp::f32x8) -> pulp::f32x8 {
        self.0.add_f32x8(a, b)
    }

    #[inline(always)]
    fn difference(self, a: pulp::f32x8, b: pulp::f32x8) -> pulp::f32x8 {
        self.0.sub_f32x8(a, b)
    }

    #[inline(always)]
    fn product(self, a: pulp::f32x8, b: pulp::f32x8) -> pulp::f32x8 {
        self.0.mul_f32x8(a, b)
    }

    #[inline(always)]
    fn magnitude(self, a: pulp::f32x8) -> pulp::f32x8 {
        self.0.abs_f32x8(a)
    }

    #[inline(always)]
    fn lower(self, a: pulp::f32x8, b: pulp::f32x8) -> pulp::f32x8 {
        self.0.min_f32x8(a, b)
    }

    #[inline(always)]
    fn higher(self, a: pulp::f32x8, b: pulp::f32x8) -> pulp::f32x8 {
        self.0.max_f32x8(a, b)
    }

    #[inline(always)]
    fn positive(self, a: pulp::f32x8) -> u32 {
        let is_positive = self.0.cmp_gt_f32x8(a, self.0.splat_f32x8(0.0));
        self.0.avx._mm256_movemask_ps(pulp::cast(is_positive)).cast_unsigned()
    }

    #[inline(always)]
    fn choose(self, condition: pulp::f32x8, yes: pulp::f32x8, no: pulp::f32x8) -> pulp::f32x8 {
        self.0.select_f32x8(self.0.cmp_gt_f32x8(condition, self.0.splat_f32x8(0.0)), yes, no)
    }
}

#[cfg(target_arch = "x86_64")]
impl Eights for Singles<pulp::x86::V3> {
    /// A point is one load; four by four they are turned into rows of coordinates.
    #[inline(always)]
    fn gather(self, points: &[Mapped], at: &[u32; WIDTH]) -> [pulp::f32x8; 3] {
        let avx = self.0.avx;
        let a = two(points, at[0], at[4]);
        let b = two(points, at[1], at[5]);
        let c = two(points, at[2], at[6]);
        let d = two(points, at[3], at[7]);
        let (low, high) = (avx._mm256_unpacklo_ps(a, b), avx._mm256_unpacklo_ps(c, d));
        let x = avx._mm256_shuffle_ps::<0b01_00_01_00>(low, high);
        let y = avx._mm256_shuffle_ps::<0b11_10_11_10>(low, high);
        let (low, high) = (avx._mm256_unpackhi_ps(a, b), avx._mm256_unpackhi_ps(c, d));
        let z = avx._mm256_shuffle_ps::<0b01_00_01_00>(low, high);
        [pulp::cast(x), pulp::cast(y), pulp::cast(z)]
    }
}

/// Two points side by side.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn two(points: &[Mapped], one: u32, other: u32) -> std::arch::x86_64::__m256 {
    pulp::cast([points[one as usize], points[other as usize]])
}
