//! Writing PLY: a file that was read with other positions, or a mesh from scratch.

use std::io::{self, Write};

use super::{
    super::{MeshFile, WriteError, text},
    header::{Encoding, Scalar},
    read::PlyDocument,
};

impl PlyDocument {
    /// Whether all coordinates are singles.
    pub(crate) fn is_single_precision(&self) -> bool {
        self.types == [Scalar::F32; 3]
    }

    /// Why no vertex can move, if so.
    pub(crate) fn fixed(&self) -> Option<&'static str> {
        let is_real = |scalar: &Scalar| matches!(scalar, Scalar::F32 | Scalar::F64);
        (!self.types.iter().all(is_real)).then_some("its coordinates are integers")
    }

    /// Writes the file with other positions; where nothing moved, every byte is as it was.
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

    /// Positions as the file can hold them. A coordinate that rounds to the single that it was before stays as it was: text may
    /// have more digits than a single has.
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

/// Writes meshes one after the other into one binary little-endian PLY in double precision, polygons kept.
///
/// `positions` holds the vertices of all meshes in metres, in order; missing ones are taken from the files. Texture coordinates are written
/// as a list of each face where it has them.
///
/// # Errors
/// What writing to `out` gives.
pub fn write_ply(meshes: &[MeshFile], positions: &[[f64; 3]], out: &mut dyn Write) -> io::Result<()> {
    let num_vertices: usize = meshes.iter().map(|mesh| mesh.positions().len()).sum();
    let num_faces: usize = meshes.iter().map(|mesh| mesh.polygons().len()).sum();
    let has_uvs = meshes.iter().any(|mesh| !mesh.uv_coordinates().is_empty());
    writeln!(out, "ply\nformat binary_little_endian 1.0\nelement vertex {num_vertices}")?;
    writeln!(out, "property double x\nproperty double y\nproperty double z\nelement face {num_faces}")?;
    writeln!(out, "property list uint uint vertex_indices")?;
    if has_uvs {
        writeln!(out, "property list uint double texcoord")?;
    }
    writeln!(out, "end_header")?;
    let own = meshes.iter().flat_map(MeshFile::positions);
    for (vertex, own) in own.enumerate() {
        for coordinate in positions.get(vertex).unwrap_or(own) {
            out.write_all(&coordinate.to_le_bytes())?;
        }
    }
    let too_large = |_| io::Error::new(io::ErrorKind::InvalidInput, "more than 2^32 elements");
    let mut first_vertex = 0;
    for mesh in meshes {
        let polygons = mesh.polygons();
        for polygon in 0..polygons.len() {
            let corners = polygons.corners(polygon);
            out.write_all(&u32::try_from(corners.len()).map_err(too_large)?.to_le_bytes())?;
            for &corner in corners {
                out.write_all(&u32::try_from(first_vertex + corner as usize).map_err(too_large)?.to_le_bytes())?;
            }
            if has_uvs {
                let uvs = polygons.uv_corners(polygon).unwrap_or_default();
                out.write_all(&u32::try_from(2 * uvs.len()).map_err(too_large)?.to_le_bytes())?;
                for coordinate in uvs.iter().flat_map(|&uv| mesh.uv_coordinates()[uv as usize]) {
                    out.write_all(&coordinate.to_le_bytes())?;
                }
            }
        }
        first_vertex += mesh.positions().len();
    }
    Ok(())
}
