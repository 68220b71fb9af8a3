//! The numbers in which polynomials are compared: intervals that hold the exact value, and whole numbers.

use std::cmp::Ordering;

use num_bigint::{BigInt, Sign};

use crate::primitive::Point;

/// What the polynomials need.
pub(super) trait Number: Sized {
    fn plus(&self, other: &Self) -> Self;
    fn minus(&self, other: &Self) -> Self;
    fn times(&self, other: &Self) -> Self;
    /// The order to zero, if that is known.
    fn order(&self) -> Option<Ordering>;

    /// Whether it is less than another one, if that is known.
    fn is_less(&self, other: &Self) -> Option<bool> {
        self.minus(other).order().map(|order| order == Ordering::Less)
    }
}

/// Two numbers between which the exact value lies. An end that is NaN or infinite tells nothing.
#[derive(Clone, Copy, Debug)]
pub(super) struct Interval {
    low: f64,
    high: f64,
}

impl Interval {
    pub(super) fn exactly(value: f64) -> Self {
        Self { low: value, high: value }
    }

    /// One number further out than rounding may have led.
    fn outward(low: f64, high: f64) -> Self {
        Self { low: low.next_down(), high: high.next_up() }
    }
}

impl Number for Interval {
    fn plus(&self, other: &Self) -> Self {
        Self::outward(self.low + other.low, self.high + other.high)
    }

    fn minus(&self, other: &Self) -> Self {
        Self::outward(self.low - other.high, self.high - other.low)
    }

    fn times(&self, other: &Self) -> Self {
        let products = [self.low * other.low, self.low * other.high, self.high * other.low, self.high * other.high];
        if products.iter().any(|product| product.is_nan()) {
            return Self { low: f64::NEG_INFINITY, high: f64::INFINITY };
        }
        let least = products.iter().copied().fold(f64::INFINITY, f64::min);
        let greatest = products.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        Self::outward(least, greatest)
    }

    fn order(&self) -> Option<Ordering> {
        if self.low > 0.0 {
            Some(Ordering::Greater)
        } else if self.high < 0.0 {
            Some(Ordering::Less)
        } else {
            None
        }
    }
}

impl Number for BigInt {
    fn plus(&self, other: &Self) -> Self {
        self + other
    }

    fn minus(&self, other: &Self) -> Self {
        self - other
    }

    fn times(&self, other: &Self) -> Self {
        self * other
    }

    fn order(&self) -> Option<Ordering> {
        Some(match self.sign() {
            Sign::Minus => Ordering::Less,
            Sign::NoSign => Ordering::Equal,
            Sign::Plus => Ordering::Greater,
        })
    }
}

/// Points and a distance as whole multiples of the largest power of two of which all of them are multiples, or of a
/// smaller one.
pub(super) fn whole<const N: usize>(points: [Point; N], distance: f64) -> ([[BigInt; 3]; N], BigInt) {
    let exponent = |value: f64| if value == 0.0 { i32::MAX } else { split(value).1 };
    let least = points.iter().flatten().map(|&value| exponent(value)).fold(exponent(distance), i32::min);
    let number = |value: f64| {
        let (digits, exponent) = split(value);
        if digits == 0 { BigInt::ZERO } else { BigInt::from(digits) << (exponent - least).unsigned_abs() }
    };
    (points.map(|point| point.map(number)), number(distance))
}

/// A finite number as digits times a power of two.
fn split(value: f64) -> (i64, i32) {
    // Doubling is exact, and so is the product with a power of two that makes the digits whole.
    let (mut digits, mut exponent) = (value, 0);
    if digits.abs() < f64::MIN_POSITIVE {
        digits *= 2.0_f64.powi(200);
        exponent -= 200;
    }
    let bits = i32::try_from(digits.to_bits() >> 52 & 0x7ff).unwrap_or_default() - 1023;
    let shift = 52 - bits;
    // In two parts, since the power itself may be too large.
    let scaled = digits * 2.0_f64.powi(shift / 2) * 2.0_f64.powi(shift - shift / 2);
    #[expect(clippy::cast_possible_truncation, reason = "whole, and below 2^53")]
    let digits = scaled as i64;
    (digits, exponent - shift)
}
