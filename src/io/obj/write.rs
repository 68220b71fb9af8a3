//! Writing OBJ from scratch: several files as one, or a mesh that came from another format.

use std::io::{self, Write};

use super::super::{MeshFile, text::write_number};

/// Writes meshes one after the other into one OBJ, each as an object of its own, polygons and texture coordinates kept.
///
/// `positions` holds the vertices of all meshes in metres, in order; missing ones are taken from the files.
///
/// # Errors
/// What writing to `out` gives.
pub fn write_obj(meshes: &[MeshFile], positions: &[[f64; 3]], out: &mut dyn Write) -> io::Result<()> {
    let (mut first_vertex, mut first_uv) = (1, 1);
    for (number, mesh) in meshes.iter().enumerate() {
        let name = mesh.path().file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        let name: String = name.chars().map(|c| if c.is_whitespace() || c.is_control() { '_' } else { c }).collect();
        writeln!(out, "o {}", if name.is_empty() { format!("piece_{number}") } else { name })?;
        for (vertex, own) in mesh.positions().iter().enumerate() {
            let position = positions.get(first_vertex - 1 + vertex).unwrap_or(own);
            write!(out, "v")?;
            for &coordinate in position {
                write!(out, " ")?;
                write_number(coordinate, out)?;
            }
            writeln!(out)?;
        }
        for [u, v] in mesh.uv_coordinates() {
            write!(out, "vt ")?;
            write_number(*u, out)?;
            write!(out, " ")?;
            write_number(*v, out)?;
            writeln!(out)?;
        }
        let polygons = mesh.polygons();
        for polygon in 0..polygons.len() {
            write!(out, "f")?;
            let uvs = polygons.uv_corners(polygon);
            for (k, &corner) in polygons.corners(polygon).iter().enumerate() {
                write!(out, " {}", first_vertex + corner as usize)?;
                if let Some(uvs) = uvs {
                    write!(out, "/{}", first_uv + uvs[k] as usize)?;
                }
            }
            writeln!(out)?;
        }
        first_vertex += mesh.positions().len();
        first_uv += mesh.uv_coordinates().len();
    }
    Ok(())
}
