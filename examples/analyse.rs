//! Global intersection analysis as a library, without any other process: reads mesh files, or folds a sheet through
//! itself, and prints every intersection path with its type and its inside regions.
//!
//! ```sh
//! cargo run --release --example analyse              # a generated sheet
//! cargo run --release --example analyse -- dress.obj # one file or several
//! ```

use std::{error::Error, path::PathBuf};

use untangle::{
    analysis::analyse,
    frame::Frame,
    mesh::{Mesh, MeshDescription, Uvs},
};
use untangled_mesh_io::{concatenate, read_mesh};

fn main() -> Result<(), Box<dyn Error>> {
    let files: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let (description, positions) = if files.is_empty() {
        folded_sheet(24)
    } else {
        let meshes = files.iter().map(read_mesh).collect::<Result<Vec<_>, _>>()?;
        let world = concatenate(&meshes)?;
        (world.description, world.positions)
    };

    // The mesh is validated once; positions change from frame to frame.
    let mesh = Mesh::new(description)?;
    let frame = Frame::new(&mesh, &positions)?;
    let analysis = analyse(&mesh, &frame);

    print(&format!("{} faces in {} pieces", mesh.num_faces(), mesh.num_pieces()));
    print(&format!("{} pairs of faces intersect", analysis.intersections.segments.len()));
    for pair in &analysis.paths.pairs {
        print(&format!("{:?}, {:.4} m, {} face pairs", pair.pair_type, pair.length_m, pair.num_segments));
        for copy in pair.copies.clone() {
            let path = &analysis.paths.copies[copy];
            let inside = analysis.regions.vertices_of(copy).len();
            print(&format!("  {:?}: {} segments, {inside} vertices inside", path.path_type, path.segments.len()));
        }
    }
    Ok(())
}

#[expect(clippy::print_stdout, reason = "an example prints what it finds")]
fn print(line: &str) {
    println!("{line}");
}

/// A sheet of 1 m x 1 m, folded over with both layers pushed through each other in the middle: one closed path on each
/// layer.
fn folded_sheet(resolution: u32) -> (MeshDescription, Vec<[f64; 3]>) {
    let row = resolution + 1;
    let uvs: Vec<[f64; 2]> =
        (0..row * row).map(|k| [k % row, k / row].map(|i| f64::from(i) / f64::from(resolution))).collect();
    let mut faces = Vec::new();
    for y in 0..resolution {
        for x in 0..resolution {
            let [a, b, c, d] = [y * row + x, y * row + x + 1, (y + 1) * row + x + 1, (y + 1) * row + x];
            faces.extend([[a, b, c], [a, c, d]]);
        }
    }
    let positions = uvs.iter().map(|&[u, v]| fold(2.0 * u - 1.0, v)).collect();
    let description = MeshDescription {
        num_vertices: uvs.len(),
        uvs: Some(Uvs { coordinates: uvs, corners: faces.clone() }),
        faces,
        ..Default::default()
    };
    (description, positions)
}

/// Where the point of the sheet at `u` (-1 to 1 across the fold) and `v` (0 to 1 along it) goes. The layers `u` and
/// `-u` lie at heights of opposite sign, which change where the bump is.
fn fold(u: f64, v: f64) -> [f64; 3] {
    let across = 0.5 * (u * u + 0.01).sqrt();
    let from_centre = ((across - 0.3).powi(2) + (v - 0.47).powi(2)).sqrt();
    let gap = 0.05 - 0.12 * (-(from_centre / 0.15).powi(2)).exp();
    // A little lopsided, so that no vertex of one layer lies exactly above one of the other.
    [across + 0.003 * u, v + 0.002 * u, gap * (u / 0.2).tanh()]
}
