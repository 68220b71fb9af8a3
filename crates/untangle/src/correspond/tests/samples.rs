//! Meshes made by hand for unit tests.

use nalgebra::Point2;

use crate::mesh::{Mesh, MeshDescription};

/// A flat sheet of `columns x rows` squares with edges of `edge_m`, two triangles each, and its flat coordinates.
pub(crate) fn sheet(columns: u32, rows: u32, edge_m: f64) -> (Mesh, Vec<Point2<f64>>) {
    let mut flat = Vec::new();
    for row in 0..=rows {
        for column in 0..=columns {
            flat.push(Point2::new(f64::from(column) * edge_m, f64::from(row) * edge_m));
        }
    }
    let mesh = Mesh::new(MeshDescription {
        num_vertices: flat.len(),
        faces: sheet_faces(columns, rows),
        ..Default::default()
    })
    .unwrap();
    (mesh, flat)
}

/// The triangles of such a sheet.
pub(crate) fn sheet_faces(columns: u32, rows: u32) -> Vec<[u32; 3]> {
    let mut faces = Vec::new();
    for row in 0..rows {
        for column in 0..columns {
            let a = row * (columns + 1) + column;
            let c = a + columns + 1;
            faces.push([a, a + 1, c]);
            faces.push([c, a + 1, c + 1]);
        }
    }
    faces
}

/// A tube of `columns` squares round and `rows` squares long.
pub(crate) fn tube(columns: u32, rows: u32) -> Mesh {
    Mesh::new(MeshDescription {
        num_vertices: (columns * (rows + 1)) as usize,
        faces: tube_faces(columns, rows),
        ..Default::default()
    })
    .unwrap()
}

/// The triangles of such a tube: vertex `row * columns + column`.
pub(crate) fn tube_faces(columns: u32, rows: u32) -> Vec<[u32; 3]> {
    let mut faces = Vec::new();
    for row in 0..rows {
        for column in 0..columns {
            let (a, b) = (row * columns + column, row * columns + (column + 1) % columns);
            faces.push([a, b, a + columns]);
            faces.push([a + columns, b, b + columns]);
        }
    }
    faces
}
