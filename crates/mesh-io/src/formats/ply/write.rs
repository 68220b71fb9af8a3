//! Writing a PLY file back with other positions.

use std::io::Write;

use crate::{error::WriteError, formats::text};

use super::{
    header::{Encoding, Scalar},
    read::PlyDocument,
};

impl PlyDocument {
    /// Whether all coordinates are stored in single precision.
    pub(crate) fn is_single_precision(&self) -> bool {
        self.types == [Scalar::F32; 3]
    }

    /// The reason why no position can change, if there is one.
    pub(crate) fn fixed(&self) -> Option<&'static str> {
        let is_real = |scalar: &Scalar| matches!(scalar, Scalar::F32 | Scalar::F64);
        (!self.types.iter().all(is_real)).then_some("its coordinates are integers")
    }

    /// Writes the file with other positions; only the bytes of coordinates that changed are replaced.
    pub(crate) fn write(&self, before: &[[f64; 3]], after: &[[f64; 3]], out: &mut dyn Write) -> Result<(), WriteError> {
        let stored = self.stored(before, after)?;
        if self.encoding == Encoding::Ascii {
            return Ok(text::write_replaced(&self.source, &self.coordinate_offsets, before, &stored, out)?);
        }
        let mut bytes = self.source.clone();
        for (vertex, (before, after)) in before.iter().zip(&stored).enumerate() {
            for axis in 0..3 {
                if before[axis].to_bits() == after[axis].to_bits() {
                    continue;
                }
                let start = self.coordinate_offsets[vertex][axis];
                let scalar = self.types[axis];
                let mut encoded = match scalar {
                    #[expect(clippy::cast_possible_truncation, reason = "it is a single already")]
                    Scalar::F32 => (after[axis] as f32).to_le_bytes().to_vec(),
                    _ => after[axis].to_le_bytes().to_vec(),
                };
                if self.encoding == Encoding::BigEndian {
                    encoded.reverse();
                }
                bytes[start..start + scalar.size()].copy_from_slice(&encoded);
            }
        }
        Ok(out.write_all(&bytes)?)
    }

    /// Positions rounded to the types of the file. A coordinate whose single does not change keeps its old value, since
    /// text may have more digits than a single.
    fn stored(&self, before: &[[f64; 3]], after: &[[f64; 3]]) -> Result<Vec<[f64; 3]>, WriteError> {
        let mut stored = after.to_vec();
        for (vertex, (before, after)) in before.iter().zip(&mut stored).enumerate() {
            let fixed = |reason: &str| WriteError::FixedCoordinates { vertex, reason: reason.to_owned() };
            for axis in 0..3 {
                if before[axis].to_bits() == after[axis].to_bits() {
                    continue;
                }
                #[expect(clippy::cast_possible_truncation, reason = "the file holds single precision")]
                let single = |value: f64| f64::from(value as f32);
                if let Some(reason) = self.fixed() {
                    return Err(fixed(reason));
                }
                if self.types[axis] == Scalar::F32 {
                    let rounded = single(after[axis]);
                    if !rounded.is_finite() {
                        return Err(fixed("it is beyond single precision"));
                    }
                    let is_same = rounded.to_bits() == single(before[axis]).to_bits();
                    after[axis] = if is_same { before[axis] } else { rounded };
                }
            }
        }
        Ok(stored)
    }
}
