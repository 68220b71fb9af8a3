//! Writing a PLY file back with other positions.

use std::{io::Write, ops::Range};

use crate::{error::WriteError, formats::text};

use super::{
    header::{Encoding, Scalar},
    read::PlyDocument,
};

impl PlyDocument {
    /// Whether all coordinates are stored in single precision.
    pub(crate) fn is_single_precision(&self) -> bool {
        self.types.iter().all(|(_, types)| *types == [Scalar::F32; 3])
    }

    /// Ranges of vertices whose positions can't change, each with the reason.
    pub(crate) fn fixed_vertices(&self) -> impl Iterator<Item = (Range<usize>, &'static str)> {
        let is_real = |scalar: &Scalar| matches!(scalar, Scalar::F32 | Scalar::F64);
        let fixed =
            self.types.iter().filter(move |(vertices, types)| !vertices.is_empty() && !types.iter().all(is_real));
        fixed.map(|(vertices, _)| (vertices.clone(), "its coordinates are integers"))
    }

    /// Writes the file with other positions; only the bytes of coordinates that changed are replaced.
    pub(crate) fn write(&self, before: &[[f64; 3]], after: &[[f64; 3]], out: &mut dyn Write) -> Result<(), WriteError> {
        let stored = self.stored(before, after)?;
        if self.encoding == Encoding::Ascii {
            return Ok(text::write_replaced(&self.source, &self.coordinate_offsets, before, &stored, out)?);
        }
        let mut bytes = self.source.clone();
        for (vertices, types) in &self.types {
            for vertex in vertices.clone() {
                let (before, after, starts) = (before[vertex], stored[vertex], self.coordinate_offsets[vertex]);
                for axis in (0..3).filter(|&axis| before[axis].to_bits() != after[axis].to_bits()) {
                    let mut encoded = match types[axis] {
                        #[expect(clippy::cast_possible_truncation, reason = "it is a single already")]
                        Scalar::F32 => (after[axis] as f32).to_le_bytes().to_vec(),
                        _ => after[axis].to_le_bytes().to_vec(),
                    };
                    if self.encoding == Encoding::BigEndian {
                        encoded.reverse();
                    }
                    bytes[starts[axis]..starts[axis] + encoded.len()].copy_from_slice(&encoded);
                }
            }
        }
        Ok(out.write_all(&bytes)?)
    }

    /// Positions rounded to the types of the file, as reading the written file gives them. A coordinate whose single
    /// does not change keeps its old value, since text may have more digits than a single.
    pub(crate) fn stored(&self, before: &[[f64; 3]], after: &[[f64; 3]]) -> Result<Vec<[f64; 3]>, WriteError> {
        let mut stored = after.to_vec();
        for (vertices, types) in &self.types {
            for vertex in vertices.clone() {
                let (before, moved) = (before[vertex], after[vertex]);
                for axis in (0..3).filter(|&axis| before[axis].to_bits() != moved[axis].to_bits()) {
                    stored[vertex][axis] = rounded(types[axis], before[axis], moved[axis])
                        .map_err(|reason| WriteError::FixedCoordinates { vertex, reason: reason.to_owned() })?;
                }
            }
        }
        Ok(stored)
    }
}

/// A coordinate that changes, rounded to its type.
fn rounded(scalar: Scalar, before: f64, after: f64) -> Result<f64, &'static str> {
    #[expect(clippy::cast_possible_truncation, reason = "the file holds single precision")]
    let single = |value: f64| f64::from(value as f32);
    match scalar {
        Scalar::F64 => Ok(after),
        Scalar::F32 if !single(after).is_finite() => Err("it is beyond single precision"),
        Scalar::F32 if single(after).to_bits() == single(before).to_bits() => Ok(before),
        Scalar::F32 => Ok(single(after)),
        _ => Err("its coordinates are integers"),
    }
}
