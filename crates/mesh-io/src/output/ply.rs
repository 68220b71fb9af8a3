//! Several files as one PLY.

use std::io::{self, Write};

use crate::mesh_file::MeshFile;

/// Writes meshes one after the other into one binary little-endian PLY in double precision, polygons kept.
///
/// `positions` holds the vertices of all meshes in metres, `num_vertices x 3`; where it ends early, the positions of
/// the files are written. Texture coordinates are written as a list of each face where it has them.
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
