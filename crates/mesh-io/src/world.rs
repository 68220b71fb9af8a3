//! Several files in one world.

use std::ops::Range;

use untangle::mesh::{MeshDescription, Uvs};

use crate::{error::ReadErrorKind, mesh_file::MeshFile};

/// Several files in one world.
#[derive(Clone, Debug)]
pub struct World {
    /// The mesh of all files together. It has texture coordinates if any file has them; all corners of a file without
    /// then share one point, which stands for none.
    pub description: MeshDescription,
    /// Positions in metres, `num_vertices x 3`.
    pub positions: Vec<[f64; 3]>,
    /// The vertices of each file.
    pub file_vertices: Vec<Range<usize>>,
    /// The faces of each file.
    pub file_faces: Vec<Range<usize>>,
}

/// Puts files into one world: vertices, faces and texture coordinates one file after the other.
///
/// # Errors
/// [`ReadErrorKind::Malformed`] if the files together have more vertices than 32-bit indices can name.
pub fn concatenate<'a>(files: impl IntoIterator<Item = &'a MeshFile> + Clone) -> Result<World, ReadErrorKind> {
    let mut world = World {
        description: MeshDescription::default(),
        positions: Vec::new(),
        file_vertices: Vec::new(),
        file_faces: Vec::new(),
    };
    let with_uvs = files.clone().into_iter().any(|file| file.uv_faces().is_some());
    let mut uvs = Uvs::default();
    let faces = &mut world.description.faces;
    for file in files {
        let (first_vertex, first_face) = (world.positions.len(), faces.len());
        let last = u32::try_from(first_vertex + file.positions().len()).map_err(|_| too_many_vertices())?;
        let vertex_offset = last - u32::try_from(file.positions().len()).map_err(|_| too_many_vertices())?;
        world.positions.extend_from_slice(file.positions());
        faces.extend(file.faces().iter().map(|face| face.map(|vertex| vertex + vertex_offset)));
        if with_uvs {
            append_uvs(&mut uvs, file)?;
        }
        world.file_vertices.push(first_vertex..world.positions.len());
        world.file_faces.push(first_face..faces.len());
    }
    world.description.num_vertices = world.positions.len();
    world.description.uvs = with_uvs.then_some(uvs);
    Ok(world)
}

/// Appends the texture coordinates of a file, or one point for all corners of a file without.
fn append_uvs(uvs: &mut Uvs, file: &MeshFile) -> Result<(), ReadErrorKind> {
    let offset = u32::try_from(uvs.coordinates.len()).map_err(|_| too_many_vertices())?;
    let num_coordinates = file.uv_coordinates().len();
    u32::try_from(uvs.coordinates.len() + num_coordinates + 1).map_err(|_| too_many_vertices())?;
    if let Some(uv_faces) = file.uv_faces() {
        uvs.coordinates.extend_from_slice(file.uv_coordinates());
        uvs.corners.extend(uv_faces.iter().map(|face| face.map(|uv| uv + offset)));
    } else {
        uvs.coordinates.push([0.0; 2]);
        uvs.corners.extend(file.faces().iter().map(|_| [offset; 3]));
    }
    Ok(())
}

fn too_many_vertices() -> ReadErrorKind {
    ReadErrorKind::Malformed("the files have more vertices than 32-bit indices can name".into())
}
