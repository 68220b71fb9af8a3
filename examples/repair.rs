//! Repairs a mesh file as a library: relaxes it until nothing intersects, and writes it with everything else as it was.
//!
//! ```sh
//! cargo run --release --example repair -- dress.obj repaired.obj
//! ```
//!
//! `untangled fix` does the same for several files at once, with pins and a report, and replaces no file before it has
//! been checked.

use std::{error::Error, fs::File, io::BufWriter, ops::ControlFlow};

use untangle::{
    mesh::Mesh,
    relax::{RelaxSettings, relax},
};
use untangled_mesh_io::{concatenate, read_mesh};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [input, output] = &arguments[..] else { return Err("usage: repair INPUT OUTPUT".into()) };
    let file = read_mesh(input)?;
    let world = concatenate(std::slice::from_ref(&file))?;
    let mesh = Mesh::new(world.description)?;

    let relaxation = relax(&mesh, &world.positions, &RelaxSettings::default(), &mut |step| {
        print(&format!("{} edges pierce a face, by {:?}", step.num_edge_face_intersections, step.method));
        // `Break` ends early, with the best state so far.
        ControlFlow::Continue(())
    })?;
    for path in &relaxation.blocked {
        print(&format!("{:?} of {:.4} m remains: {}", path.pair_type, path.length_m, path.reason));
    }
    file.write_with_positions(&relaxation.positions, &mut BufWriter::new(File::create(output)?))?;
    if relaxation.blocked.is_empty() { Ok(()) } else { Err("some intersections remain".into()) }
}

#[expect(clippy::print_stdout, reason = "an example prints what it does")]
fn print(line: &str) {
    println!("{line}");
}
