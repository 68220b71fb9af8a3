//! The pictures of before and after.

use std::path::Path;

use untangled_publisher::{obj, report::Summary};

use untangle::{
    analysis::analyse,
    frame::Frame,
    mesh::{Mesh, MeshDescription, Uvs},
};

use crate::cli::picture::{Picture, View};

use super::error::DemoError;

/// Size of the pictures in pixels.
const PICTURE: [usize; 2] = [1600, 1000];

/// Draws before.obj and after.obj of a folder, both in the view of the first. Returns the mesh of the last.
pub(super) fn draw(folder: &Path, summary: &Summary) -> Result<Mesh, DemoError> {
    let before = state(folder, "before")?;
    let after = state(folder, "after")?;
    let view = View::of(before.1.positions(), PICTURE[0], PICTURE[1]);
    for (name, count, (mesh, frame)) in
        [("before", summary.num_edge_face_before, &before), ("after", summary.num_edge_face_after, &after)]
    {
        let title = format!("{name}: {count} edge-face intersections");
        let picture = Picture::draw(&view, mesh, frame, &analyse(mesh, frame), &title);
        let path = folder.join(name).with_extension("png");
        picture.write_png(&path).map_err(|source| DemoError::Picture { path, source })?;
    }
    Ok(after.0)
}

/// Reads one state.
fn state(folder: &Path, name: &str) -> Result<(Mesh, Frame), DemoError> {
    let cloth = obj::read(&folder.join(name).with_extension("obj"))?;
    let positions = cloth.points();
    let mesh = Mesh::new(MeshDescription {
        num_vertices: positions.len(),
        faces: cloth.triangles,
        uvs: cloth.uvs.map(|uvs| Uvs { coordinates: uvs.coordinates, corners: uvs.corners }),
        ..MeshDescription::default()
    })?;
    let frame = Frame::new(&mesh, &positions)?;
    Ok((mesh, frame))
}
