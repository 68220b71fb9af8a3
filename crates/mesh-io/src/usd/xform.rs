//! The transforms of prims: `xformOpOrder` and its ops, at a time code.

use std::sync::Arc;

use nalgebra::{Matrix4, Quaternion, Rotation3, UnitQuaternion, Vector3};

use super::{
    compose::{Attribute, ComposedPrim, Stage},
    fault::UsdError,
    layers::value::Value,
};

/// The transform of a prim to the world.
#[derive(Clone, Debug, Default)]
pub(super) struct Xform {
    /// The ops of the prim and of those above it, as they are multiplied from the left.
    ops: Vec<Arc<Op>>,
}

#[derive(Clone, Debug)]
struct Op {
    kind: Kind,
    is_inverse: bool,
    prim: String,
    attribute: Attribute,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Translate,
    Scale,
    /// Round these axes, one after the other.
    Rotate(&'static str),
    Orient,
    Matrix,
}

const ROTATIONS: [&str; 9] = ["X", "Y", "Z", "XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX"];

impl Xform {
    /// The transform of a prim within that of the prim above it.
    pub(super) fn below(&self, stage: &Stage, prim: &ComposedPrim) -> Result<Self, UsdError> {
        let mut xform = self.clone();
        let Some(order) = prim.attribute("xformOpOrder") else { return Ok(xform) };
        let Some(Value::Texts(names)) = stage.default(&order)? else { return Ok(xform) };
        for name in names {
            if name == "!resetXformStack!" {
                xform.ops.clear();
                continue;
            }
            let (name, is_inverse) = name.strip_prefix("!invert!").map_or((name.as_str(), false), |name| (name, true));
            let kind = kind(name)
                .ok_or_else(|| stage.error(&prim.path, format!("has the transform {name}, which is not known")))?;
            let Some(attribute) = prim.attribute(name) else { continue };
            if attribute.has_spline {
                return Err(
                    stage.error(&prim.path, format!("has {name} as a curve, which is not read; bake it to samples"))
                );
            }
            xform.ops.push(Arc::new(Op { kind, is_inverse, prim: prim.path.clone(), attribute }));
        }
        Ok(xform)
    }

    /// Whether it is the same at all times.
    pub(super) fn is_static(&self) -> bool {
        self.ops.iter().all(|op| op.attribute.samples.is_empty())
    }

    /// The matrix to the world at a time code; without one, of the first sample where there is no other value.
    pub(super) fn matrix(&self, stage: &Stage, time: Option<f64>) -> Result<Matrix4<f64>, UsdError> {
        let mut matrix = Matrix4::identity();
        for op in &self.ops {
            let own = op.matrix(stage, time)?;
            let inverse = own.try_inverse().filter(|inverse| inverse.iter().all(|value| value.is_finite()));
            let inverse = inverse.ok_or_else(|| {
                stage.error(&op.prim, format!("{} is a transform that can't be inverted", op.attribute.name))
            })?;
            matrix *= if op.is_inverse { inverse } else { own };
        }
        Ok(matrix)
    }
}

/// What an op does, by the name of its attribute.
fn kind(name: &str) -> Option<Kind> {
    let mut parts = name.strip_prefix("xformOp:")?.split(':');
    Some(match parts.next()? {
        "translate" => Kind::Translate,
        "scale" => Kind::Scale,
        "orient" => Kind::Orient,
        "transform" => Kind::Matrix,
        other => {
            let axes = other.strip_prefix("rotate")?;
            Kind::Rotate(ROTATIONS.into_iter().find(|name| *name == axes)?)
        }
    })
}

impl Op {
    fn matrix(&self, stage: &Stage, time: Option<f64>) -> Result<Matrix4<f64>, UsdError> {
        let Some(numbers) = self.numbers(stage, time)? else { return Ok(Matrix4::identity()) };
        self.kind
            .matrix(&numbers)
            .filter(|matrix| matrix.iter().all(|value| value.is_finite()))
            .ok_or_else(|| stage.error(&self.prim, "has a transform whose numbers are not those of its type"))
    }

    /// The numbers at a time code, straight between samples.
    fn numbers(&self, stage: &Stage, time: Option<f64>) -> Result<Option<Vec<f64>>, UsdError> {
        let samples = &self.attribute.samples;
        let numbers = |value: Value| match value {
            Value::Numbers(numbers) => Ok(Some(numbers)),
            Value::Blocked => Ok(None),
            _ => Err(stage.error(&self.prim, format!("has a transform of the type {}", self.attribute.type_name))),
        };
        let at = |index: usize| numbers(stage.value(&self.attribute, &samples[index].1)?);
        if samples.is_empty() || time.is_none() {
            let value = stage.default(&self.attribute)?.map(numbers).transpose()?.flatten();
            return if value.is_none() && !samples.is_empty() { at(0) } else { Ok(value) };
        }
        let time = time.unwrap_or_default();
        let after = samples.partition_point(|(sample, _)| *sample <= time);
        let before = after.saturating_sub(1);
        let after = if after == 0 { 0 } else { after.min(samples.len() - 1) };
        if before == after {
            return at(before);
        }
        let (Some(a), Some(b)) = (at(before)?, at(after)?) else { return Ok(None) };
        let share = (time - samples[before].0) / (samples[after].0 - samples[before].0);
        if share <= 0.0 || a.len() != b.len() {
            return Ok(Some(a));
        }
        if self.kind == Kind::Orient {
            return Ok(quaternion(&a).zip(quaternion(&b)).map(|(a, b)| {
                let turned = a.try_slerp(&b, share, 1e-12).unwrap_or(a);
                vec![turned.w, turned.i, turned.j, turned.k]
            }));
        }
        Ok(Some(a.iter().zip(&b).map(|(a, b)| a + share * (b - a)).collect()))
    }
}

fn quaternion(numbers: &[f64]) -> Option<UnitQuaternion<f64>> {
    let &[w, i, j, k] = numbers else { return None };
    UnitQuaternion::try_new(Quaternion::new(w, i, j, k), 0.0)
}

impl Kind {
    fn matrix(self, numbers: &[f64]) -> Option<Matrix4<f64>> {
        let vector = || <[f64; 3]>::try_from(numbers).ok().map(Vector3::from);
        Some(match self {
            Self::Translate => Matrix4::new_translation(&vector()?),
            Self::Scale => Matrix4::new_nonuniform_scaling(&vector()?),
            Self::Orient => quaternion(numbers)?.to_homogeneous(),
            // Vectors of USD are rows, those here columns.
            Self::Matrix => Matrix4::from_column_slice(<&[f64; 16]>::try_from(numbers).ok()?),
            Self::Rotate(axes) => {
                let mut matrix = Matrix4::identity();
                for (index, axis) in axes.bytes().enumerate() {
                    let degrees: f64 =
                        if axes.len() == 1 { *numbers.first()? } else { vector()?[usize::from(axis - b'X')] };
                    debug_assert!(index < 3);
                    matrix = turn(axis, degrees) * matrix;
                }
                matrix
            }
        })
    }
}

/// Quarter turns are exact.
fn turn(axis: u8, degrees: f64) -> Matrix4<f64> {
    let (sin, cos) = match degrees.rem_euclid(360.0) {
        0.0 => (0.0, 1.0),
        90.0 => (1.0, 0.0),
        180.0 => (0.0, -1.0),
        270.0 => (-1.0, 0.0),
        _ => (libm::sin(degrees.to_radians()), libm::cos(degrees.to_radians())),
    };
    let matrix = match axis {
        b'X' => [[1.0, 0.0, 0.0], [0.0, cos, -sin], [0.0, sin, cos]],
        b'Y' => [[cos, 0.0, sin], [0.0, 1.0, 0.0], [-sin, 0.0, cos]],
        _ => [[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]],
    };
    Rotation3::from_matrix_unchecked(nalgebra::Matrix3::from_fn(|row, column| matrix[row][column])).to_homogeneous()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rotations_are_applied_in_the_order_of_their_name() {
        let apply = |axes: &'static str, numbers: &[f64]| {
            let matrix = Kind::Rotate(axes).matrix(numbers).unwrap();
            matrix.transform_point(&nalgebra::Point3::new(1.0, 2.0, 3.0)).coords.as_slice().to_vec()
        };
        assert_eq!(apply("Z", &[90.0]), [-2.0, 1.0, 3.0]);
        // Round X first: (1, -3, 2); then round Y: (2, -3, -1).
        assert_eq!(apply("XYZ", &[90.0, 90.0, 0.0]), [2.0, -3.0, -1.0]);
        // Round Y first: (3, 2, -1); then round X: (3, 1, 2).
        assert_eq!(apply("ZYX", &[90.0, 90.0, 0.0]), [3.0, 1.0, 2.0]);
    }
}
