//! Coordinates as fractions.

use dashu_ratio::Relaxed;

/// A fraction; only common powers of two are cancelled, of which nearly all denominators consist.
pub(super) type Fraction = Relaxed;

/// A place, without rounding.
pub(super) type Point = [Fraction; 3];

/// A finite number in double precision as a fraction, which takes no rounding.
pub(super) fn fraction(value: f64) -> Fraction {
    Fraction::try_from(value).unwrap()
}

/// Rule 1: what the coordinates of a vertex count as; nothing where they are refused.
pub(super) fn point(coordinates: [f64; 3]) -> Option<Point> {
    let limit = |exponent: i32| fraction(2f64.powi(exponent));
    let (least, most) = (limit(-250), limit(250));
    let count = |value: f64| {
        if !value.is_finite() {
            return None;
        }
        let value = fraction(value);
        let size = if value < Fraction::ZERO { -value.clone() } else { value.clone() };
        (size <= most).then(|| if size < least { Fraction::ZERO } else { value })
    };
    let [x, y, z] = coordinates.map(count);
    Some([x?, y?, z?])
}

pub(super) fn minus(a: &Point, b: &Point) -> Point {
    std::array::from_fn(|axis| &a[axis] - &b[axis])
}

pub(super) fn dot(a: &Point, b: &Point) -> Fraction {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}
