//! Several files as one OBJ.

use std::io::{self, Write};

use crate::{
    error::WriteError,
    formats::{obj::Before, text::write_number},
    mesh_file::MeshFile,
};

/// Writes meshes one after the other into one OBJ, polygons and texture coordinates kept.
///
/// A mesh that was read from an OBJ keeps its lines; their indices are shifted. Every mesh but the first is an object
/// of its own, without the group, smoothing and material of earlier ones. `positions` holds the vertices of all meshes
/// in metres, `num_vertices x 3`; for a file that it does not cover, the positions of the file are written.
///
/// # Errors
/// [`WriteError::Join`] for free-form curves and surfaces in any file but the first, and what writing to `out` gives.
pub fn write_obj(meshes: &[MeshFile], positions: &[[f64; 3]], out: &mut dyn Write) -> Result<(), WriteError> {
    let mut before = Before::default();
    for (number, mesh) in meshes.iter().enumerate() {
        let name = mesh.path().file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        let name: String = name.chars().map(|c| if c.is_whitespace() || c.is_control() { '_' } else { c }).collect();
        let name = if name.is_empty() { format!("piece_{number}") } else { name };
        let own = mesh.positions();
        let given = positions.get(before.counts[0]..before.counts[0] + own.len()).unwrap_or(own);
        out.write_all(before.separator.as_bytes())?;
        match mesh.obj_document() {
            Some(document) => document.write_after(&mut before, &name, mesh.path(), [own, given], out)?,
            None => write_new(&mut before, &name, mesh, given, out)?,
        }
    }
    Ok(())
}

/// Writes a mesh that was not read from an OBJ.
fn write_new(
    before: &mut Before,
    name: &str,
    mesh: &MeshFile,
    positions: &[[f64; 3]],
    out: &mut dyn Write,
) -> io::Result<()> {
    writeln!(out, "o {name}")?;
    for reset in before.resets() {
        writeln!(out, "{reset}")?;
    }
    for position in positions {
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
    let [first_vertex, first_uv, _] = before.counts.map(|count| count + 1);
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
    before.counts[0] += mesh.positions().len();
    before.counts[1] += mesh.uv_coordinates().len();
    (before.separator, before.has_pieces) = ("", true);
    Ok(())
}
