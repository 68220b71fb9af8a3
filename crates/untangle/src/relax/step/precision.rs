//! Positions as the file that they go to will hold them.

use nalgebra::Point3;

/// A position, rounded to single precision where asked for.
pub(crate) fn stored(point: Point3<f64>, single_precision: bool) -> Point3<f64> {
    #[expect(clippy::cast_possible_truncation, reason = "rounding is the purpose")]
    let rounded = |value: f64| f64::from(value as f32);
    if single_precision { point.map(rounded) } else { point }
}
