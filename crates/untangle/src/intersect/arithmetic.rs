//! Numbers one by one or several at a time, for arithmetic that is written once: the same operations in the same order, none of them fused.

/// What can be done with numbers, or with several side by side.
pub(crate) trait Arithmetic: Copy {
    type Value: Copy;

    /// Relative error of one operation at most.
    const ROUNDOFF: f64;

    /// Sums of products below it may come from underflow, where errors are not relative.
    const FLOOR: f64;

    fn of(self, value: f64) -> Self::Value;
    fn sum(self, a: Self::Value, b: Self::Value) -> Self::Value;
    fn difference(self, a: Self::Value, b: Self::Value) -> Self::Value;
    fn product(self, a: Self::Value, b: Self::Value) -> Self::Value;
    fn magnitude(self, a: Self::Value) -> Self::Value;
    fn lower(self, a: Self::Value, b: Self::Value) -> Self::Value;
    fn higher(self, a: Self::Value, b: Self::Value) -> Self::Value;

    /// A bit for each number above zero.
    fn positive(self, a: Self::Value) -> u32;
    /// `yes` where `condition` is above zero, elsewhere `no`.
    fn choose(self, condition: Self::Value, yes: Self::Value, no: Self::Value) -> Self::Value;

    #[inline(always)]
    fn minus(self, a: [Self::Value; 3], b: [Self::Value; 3]) -> [Self::Value; 3] {
        [self.difference(a[0], b[0]), self.difference(a[1], b[1]), self.difference(a[2], b[2])]
    }

    #[inline(always)]
    fn dot(self, a: [Self::Value; 3], b: [Self::Value; 3]) -> Self::Value {
        self.sum(self.sum(self.product(a[0], b[0]), self.product(a[1], b[1])), self.product(a[2], b[2]))
    }

    #[inline(always)]
    fn cross(self, a: [Self::Value; 3], b: [Self::Value; 3]) -> [Self::Value; 3] {
        [
            self.difference(self.product(a[1], b[2]), self.product(a[2], b[1])),
            self.difference(self.product(a[2], b[0]), self.product(a[0], b[2])),
            self.difference(self.product(a[0], b[1]), self.product(a[1], b[0])),
        ]
    }
}

/// What else distances take.
pub(crate) trait Roots: Arithmetic {
    fn quotient(self, a: Self::Value, b: Self::Value) -> Self::Value;
    fn root(self, a: Self::Value) -> Self::Value;
}

/// Of doubles.
const ROUNDOFF: f64 = 0.5 * f64::EPSILON;
const FLOOR: f64 = 1e-290;

/// One number at a time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plain;

impl Arithmetic for Plain {
    type Value = f64;

    const ROUNDOFF: f64 = ROUNDOFF;
    const FLOOR: f64 = FLOOR;

    #[inline(always)]
    fn of(self, value: f64) -> f64 {
        value
    }

    #[inline(always)]
    fn sum(self, a: f64, b: f64) -> f64 {
        a + b
    }

    #[inline(always)]
    fn difference(self, a: f64, b: f64) -> f64 {
        a - b
    }

    #[inline(always)]
    fn product(self, a: f64, b: f64) -> f64 {
        a * b
    }

    #[inline(always)]
    fn magnitude(self, a: f64) -> f64 {
        a.abs()
    }

    /// One instruction, where `f64::min` takes several for the sake of NaN, which frames never hold.
    #[inline(always)]
    fn lower(self, a: f64, b: f64) -> f64 {
        if a < b { a } else { b }
    }

    #[inline(always)]
    fn higher(self, a: f64, b: f64) -> f64 {
        if a > b { a } else { b }
    }

    #[inline(always)]
    fn positive(self, a: f64) -> u32 {
        u32::from(a > 0.0)
    }

    #[inline(always)]
    fn choose(self, condition: f64, yes: f64, no: f64) -> f64 {
        if condition > 0.0 { yes } else { no }
    }
}

impl Roots for Plain {
    #[inline(always)]
    fn quotient(self, a: f64, b: f64) -> f64 {
        a / b
    }

    #[inline(always)]
    fn root(self, a: f64) -> f64 {
        a.sqrt()
    }
}

/// Four at a time.
#[cfg(target_arch = "x86_64")]
impl Arithmetic for pulp::x86::V3 {
    type Value = pulp::f64x4;

    const ROUNDOFF: f64 = ROUNDOFF;
    const FLOOR: f64 = FLOOR;

    #[inline(always)]
    fn of(self, value: f64) -> pulp::f64x4 {
        self.splat_f64x4(value)
    }

    #[inline(always)]
    fn sum(self, a: pulp::f64x4, b: pulp::f64x4) -> pulp::f64x4 {
        self.add_f64x4(a, b)
    }

    #[inline(always)]
    fn difference(self, a: pulp::f64x4, b: pulp::f64x4) -> pulp::f64x4 {
        self.sub_f64x4(a, b)
    }

    #[inline(always)]
    fn product(self, a: pulp::f64x4, b: pulp::f64x4) -> pulp::f64x4 {
        self.mul_f64x4(a, b)
    }

    #[inline(always)]
    fn magnitude(self, a: pulp::f64x4) -> pulp::f64x4 {
        self.abs_f64x4(a)
    }

    #[inline(always)]
    fn lower(self, a: pulp::f64x4, b: pulp::f64x4) -> pulp::f64x4 {
        self.min_f64x4(a, b)
    }

    #[inline(always)]
    fn higher(self, a: pulp::f64x4, b: pulp::f64x4) -> pulp::f64x4 {
        self.max_f64x4(a, b)
    }

    #[inline(always)]
    fn positive(self, a: pulp::f64x4) -> u32 {
        let is_positive = self.cmp_gt_f64x4(a, self.splat_f64x4(0.0));
        self.avx._mm256_movemask_pd(pulp::cast(is_positive)).cast_unsigned()
    }

    #[inline(always)]
    fn choose(self, condition: pulp::f64x4, yes: pulp::f64x4, no: pulp::f64x4) -> pulp::f64x4 {
        self.select_f64x4(self.cmp_gt_f64x4(condition, self.splat_f64x4(0.0)), yes, no)
    }
}

#[cfg(target_arch = "x86_64")]
impl Roots for pulp::x86::V3 {
    #[inline(always)]
    fn quotient(self, a: pulp::f64x4, b: pulp::f64x4) -> pulp::f64x4 {
        self.div_f64x4(a, b)
    }

    #[inline(always)]
    fn root(self, a: pulp::f64x4) -> pulp::f64x4 {
        self.sqrt_f64x4(a)
    }
}
