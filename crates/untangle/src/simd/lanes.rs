//! What can be done with a vector of lanes.

/// Lanes of a vector of single precision.
pub(crate) const F32_LANES: usize = 8;

/// Rows of double precision that go through a filter together, in vectors of as many lanes as the instruction set has.
pub(crate) const F64_LANES: usize = 4;

/// Bits of the root of 1/2, the least mantissa of [`F64Lanes::split`].
pub(super) const LEAST_MANTISSA: u64 = std::f64::consts::FRAC_1_SQRT_2.to_bits();
/// What makes the exponent of a number with that mantissa the one of 1.
pub(super) const TO_LEAST_MANTISSA: u64 = 1f64.to_bits() - LEAST_MANTISSA;
/// The bits of a number below its exponent.
pub(super) const FRACTION: u64 = (1 << 52) - 1;
/// A small whole number in the last bits of this one adds itself to the value.
pub(super) const TWO_TO_52: f64 = 4_503_599_627_370_496.0;
/// What the bits of an exponent are above it.
pub(super) const EXPONENT_BIAS: f64 = 1023.0;

/// Floating-point arithmetic on vectors, lane by lane; a scalar is a vector of one lane. No lane ever holds NaN.
pub(crate) trait Lanes: Copy {
    type Vector: Copy;

    /// Unit roundoff: the relative error of one operation at most.
    const ROUNDOFF: f64;

    /// Sums of products below it may come from underflow, where errors are not relative.
    const FLOOR: f64;

    fn splat(self, value: f64) -> Self::Vector;
    fn add(self, a: Self::Vector, b: Self::Vector) -> Self::Vector;
    fn sub(self, a: Self::Vector, b: Self::Vector) -> Self::Vector;
    fn mul(self, a: Self::Vector, b: Self::Vector) -> Self::Vector;
    fn abs(self, a: Self::Vector) -> Self::Vector;
    fn min(self, a: Self::Vector, b: Self::Vector) -> Self::Vector;
    fn max(self, a: Self::Vector, b: Self::Vector) -> Self::Vector;

    /// One bit for each lane that is above zero.
    fn gt_zero_mask(self, a: Self::Vector) -> u32;

    /// `if_positive` in the lanes where `condition` is above zero, `otherwise` in the others.
    fn select(self, condition: Self::Vector, if_positive: Self::Vector, otherwise: Self::Vector) -> Self::Vector;

    #[inline(always)]
    fn sub3(self, a: [Self::Vector; 3], b: [Self::Vector; 3]) -> [Self::Vector; 3] {
        [self.sub(a[0], b[0]), self.sub(a[1], b[1]), self.sub(a[2], b[2])]
    }

    #[inline(always)]
    fn dot(self, a: [Self::Vector; 3], b: [Self::Vector; 3]) -> Self::Vector {
        self.add(self.add(self.mul(a[0], b[0]), self.mul(a[1], b[1])), self.mul(a[2], b[2]))
    }

    #[inline(always)]
    fn cross(self, a: [Self::Vector; 3], b: [Self::Vector; 3]) -> [Self::Vector; 3] {
        [
            self.sub(self.mul(a[1], b[2]), self.mul(a[2], b[1])),
            self.sub(self.mul(a[2], b[0]), self.mul(a[0], b[2])),
            self.sub(self.mul(a[0], b[1]), self.mul(a[1], b[0])),
        ]
    }
}

/// Vectors of double precision, which hold [`WIDTH`](Self::WIDTH) of the [`F64_LANES`] entries of a row.
pub(crate) trait F64Lanes: Lanes {
    /// Lanes of one vector, a divisor of [`F64_LANES`].
    const WIDTH: usize;

    fn div(self, a: Self::Vector, b: Self::Vector) -> Self::Vector;
    fn sqrt(self, a: Self::Vector) -> Self::Vector;

    /// Exponent and mantissa of numbers above zero: `a = 2^exponent mantissa`, with a mantissa from the root of 1/2 to
    /// the root of 2. Both are finite for zero too.
    fn split(self, a: Self::Vector) -> [Self::Vector; 2];

    /// The entries of a row from `first` on, a multiple of the width.
    fn load(self, row: &[f64; F64_LANES], first: usize) -> Self::Vector;

    /// Writes the entries of a row from `first` on, a multiple of the width.
    fn store(self, vector: Self::Vector, row: &mut [f64; F64_LANES], first: usize);
}

/// Vectors of eight lanes in single precision.
pub(crate) trait F32x8Lanes: Lanes {
    type Mask: Copy;

    fn load(self, row: &[f32; F32_LANES]) -> Self::Vector;

    fn div(self, a: Self::Vector, b: Self::Vector) -> Self::Vector;

    /// Like [`splat`](Lanes::splat), from single precision.
    fn splat_f32(self, value: f32) -> Self::Vector;

    /// The first three components of the `rows` at eight indices, transposed: one vector for each component. The fourth
    /// component makes a row one load.
    fn gather(self, rows: &[[f32; 4]], indices: &[u32; F32_LANES]) -> [Self::Vector; 3];

    /// The lanes where `a <= b`.
    fn le(self, a: Self::Vector, b: Self::Vector) -> Self::Mask;
    fn and(self, a: Self::Mask, b: Self::Mask) -> Self::Mask;

    /// One bit for each lane of a mask.
    fn mask_bits(self, mask: Self::Mask) -> u32;
}
