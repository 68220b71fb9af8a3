//! Only what the scene requires: which stages run for what.

use std::sync::Arc;

use untangled::{
    frame::Frame,
    settings::{Response, Settings},
    untangler::Untangler,
};

use crate::{Failure, bent, frames::Stopwatch, header, sheet};

pub(crate) fn table() -> Result<(), Failure> {
    println!("\n## Only what the scene requires\n");
    println!(
        "Microseconds of each stage of a second frame of 2,450 triangles, and the bytes for each triangle that analysis and response keep after the first. A stage \
         that has nothing to do takes less than a microsecond, but for writing a zero for each vertex of the correction.\n"
    );
    header(&["scene", "response", "paths", "search", "paths", "regions", "targets", "response", "bytes"]);
    let crumpled = sheet::crumpled_further(2, 35, 2.5, 12);
    let mut flat = crumpled.clone();
    flat.positions = bent(&crumpled);
    let bare = crumpled.bare_mesh();
    let rbf = Response::Rbf;
    for (name, response, sheet, mesh) in [
        ("no contact", rbf, &flat, crumpled.mesh()),
        ("tangled, with texture coordinates", rbf, &crumpled, crumpled.mesh()),
        ("tangled, without", rbf, &crumpled, bare),
        ("tangled", Response::Displacement, &crumpled, crumpled.mesh()),
        ("tangled", Response::Contour, &crumpled, crumpled.mesh()),
        ("tangled", Response::Mask, &crumpled, crumpled.mesh()),
    ] {
        let mesh = Arc::new(mesh);
        let frame = Frame::new(&mesh, &sheet.positions)?;
        let elsewhere: Vec<_> = sheet.positions.iter().map(|point| point.map(|x| 2.0 * x)).collect();
        let elsewhere = Frame::new(&mesh, &elsewhere)?;
        let mut untangler = Untangler::new(mesh.clone(), Settings { response, ..Settings::default() })?;
        let mut num_paths = 0;
        let memory = allocation_counter::measure(|| {
            num_paths = untangler.process(&frame, &mut ()).analysis.paths.pairs.len();
        });
        let mut best = [f64::MAX; 5];
        for _ in 0..10 {
            untangler.process(&elsewhere, &mut ());
            let mut watch = Stopwatch::default();
            untangler.process(&frame, &mut watch);
            best = std::array::from_fn(|stage| best[stage].min(watch.stages[stage].as_secs_f64() * 1e6));
        }
        println!(
            "| {name} | {response:?} | {num_paths} | {} | {:.0} |",
            best.map(|time| format!("{time:.0}")).join(" | "),
            memory.bytes_current as f64 / mesh.num_faces() as f64,
        );
    }
    Ok(())
}
