//! Positions as a file or a host will hold them.

use nalgebra::{Point3, Vector3};

/// How exactly a displaced position is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Precision {
    /// In double precision.
    Double,
    /// Rounded to single precision, for files that hold no more.
    Single,
    /// As a host has it after adding a displacement that is sent to it in single precision.
    Sent {
        /// Whether the host adds in single precision.
        is_single: bool,
    },
}

impl Precision {
    /// The position to which a displacement leads.
    pub(crate) fn moved(self, before: Point3<f64>, displacement: Vector3<f64>) -> Point3<f64> {
        match self {
            Self::Double => before + displacement,
            Self::Single => stored(before + displacement, true),
            Self::Sent { is_single } => stored(before + sent(displacement), is_single),
        }
    }
}

/// A displacement as it is sent: rounded to single precision. Beyond the range of that it stays as it is, for callers
/// whose cloth is of any size; on the wire it is none.
pub(crate) fn sent(displacement: Vector3<f64>) -> Vector3<f64> {
    let rounded = stored(displacement.into(), true).coords;
    let is_held = |value: f64| value.is_finite() && value.abs() >= f64::from(f32::MIN_POSITIVE);
    rounded.zip_map(&displacement, |rounded, value| if is_held(rounded) { rounded } else { value })
}

/// A position, rounded to single precision where asked for.
pub(crate) fn stored(point: Point3<f64>, single_precision: bool) -> Point3<f64> {
    #[expect(clippy::cast_possible_truncation, reason = "rounding is the purpose")]
    let rounded = |value: f64| f64::from(value as f32);
    if single_precision { point.map(rounded) } else { point }
}
