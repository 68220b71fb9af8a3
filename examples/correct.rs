//! Corrections as a library, without any other process: a strip hangs through a sheet, and each step adds the forces of
//! one frame.
//!
//! ```sh
//! cargo run --release --example correct
//! ```

use std::{error::Error, sync::Arc};

use untangle::{
    frame::Frame,
    mesh::{Mesh, MeshDescription},
    respond::VertexFlags,
    settings::Settings,
    untangler::Untangler,
};

/// Mass of each vertex in kilograms.
const MASS_KG: f64 = 0.001;

fn main() -> Result<(), Box<dyn Error>> {
    let (faces, mut positions) = strip_through_sheet();
    // The mesh is validated once. With masses, corrections are forces that keep momentum.
    let mesh = Arc::new(Mesh::new(MeshDescription {
        num_vertices: positions.len(),
        faces,
        masses_kg: Some(vec![MASS_KG; positions.len()]),
        ..MeshDescription::default()
    })?);
    let mut untangler = Untangler::new(mesh.clone(), Settings::default())?;

    for step in 0..200 {
        let frame = Frame::new(&mesh, &positions)?;
        let outcome = untangler.process(&frame, &mut ());
        let num_pierced = outcome.analysis.intersections.edge_face.len();
        let num_inside = outcome.corrections.flags.iter().filter(|flags| flags.contains(VertexFlags::INSIDE)).count();
        print(&format!("step {step}: {num_pierced} edges pierce a face, {num_inside} vertices are inside"));
        if num_pierced == 0 {
            return Ok(());
        }
        // A solver adds these forces to its own, and leaves out self-collisions where flags say INSIDE or NEAR_PATH.
        // Here a step of unit length has no velocity to begin with, so that a force moves its vertex by force / mass.
        for (position, force) in positions.iter_mut().zip(&outcome.corrections.forces) {
            for (coordinate, part) in position.iter_mut().zip(force.iter()) {
                *coordinate += part / MASS_KG;
            }
        }
    }
    Err("still tangled".into())
}

/// Faces and positions in metres of a level sheet of 0.4 m and an upright strip whose lower rows are through it.
fn strip_through_sheet() -> (Vec<[u32; 3]>, Vec<[f64; 3]>) {
    let (mut faces, mut positions) = (Vec::new(), Vec::new());
    for (first, size) in [(0, 20u32), (21 * 21, 8)] {
        for k in 0..(size + 1) * (size + 1) {
            let [u, v] = [k % (size + 1), k / (size + 1)].map(|cell| 0.02 * f64::from(cell));
            let point =
                if first == 0 { [u, v, 0.01 * (9.0 * u).sin()] } else { [u + 0.113, 0.19 + 0.1 * u, v - 0.051] };
            positions.push(point);
        }
        for k in 0..size * size {
            let a = first + k / size * (size + 1) + k % size;
            faces.extend([[a, a + 1, a + size + 2], [a, a + size + 2, a + size + 1]]);
        }
    }
    (faces, positions)
}

#[expect(clippy::print_stdout, reason = "an example prints what it finds")]
fn print(line: &str) {
    println!("{line}");
}
