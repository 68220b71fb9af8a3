//! The search for pairs of primitives below a gap beside the search for intersections, as a table in Markdown.
//!
//! ```sh
//! cargo run --release -p untangled-lab --bin gap_table
//! ```
//!
//! Generated sheets, and the meshes of `../shared/data` where that folder is there. On one thread; least of several
//! runs, the tree being sorted already.

#![allow(clippy::print_stdout, clippy::cast_precision_loss, reason = "prints a table of ratios")]

use std::{fs, path::PathBuf, time::Duration};

use untangle::{
    frame::Frame,
    intersect::{Intersections, Intersector},
    mesh::Mesh,
    proximity::ProximitySearch,
};
use untangled_lab::{
    Failure,
    clock::{milliseconds, timed},
    states::bent,
    table::{print_header, print_text},
};
use untangled_mesh_io::{concatenate, read_mesh};
use untangled_testkit::{files::shared, generate::crumpled};

const RUNS: usize = 9;

fn main() -> Result<(), Failure> {
    rayon::ThreadPoolBuilder::new().num_threads(1).build()?.install(table)
}

fn table() -> Result<(), Failure> {
    print_text(
        "Milliseconds on one thread. `cold`: the search for intersections without certificates. `1 %`, `10 %`: the \
         search for pairs of primitives nearer than such a part of the mean edge, with the exact decision of each; \
         `ratio`: beside `cold`. `nearest`: the nearest pair alone.\n",
    );
    print_header(&["mesh", "#Tri", "cold", "pairs 1 %", "1 %", "ratio", "pairs 10 %", "10 %", "ratio", "nearest"]);
    for resolution in [35, 79, 125, 250] {
        let sheet = crumpled(11, resolution);
        let mesh = sheet.mesh();
        row(&format!("bent {resolution}"), &mesh, &bent(&sheet))?;
        row(&format!("crumpled {resolution}"), &mesh, &sheet.positions)?;
    }
    let Some(folder) = shared("data") else { return Ok(()) };
    let mut files: Vec<PathBuf> = fs::read_dir(folder)?.flatten().map(|entry| entry.path()).collect();
    files.retain(|file| file.extension().is_some_and(|kind| kind == "obj" || kind == "ply"));
    files.sort();
    for file in files {
        let world = concatenate(&[read_mesh(&file)?])?;
        let name = file.file_stem().unwrap_or_default().display().to_string();
        row(&name, &Mesh::new(world.description)?, &world.positions)?;
    }
    Ok(())
}

fn row(name: &str, mesh: &Mesh, positions: &[[f64; 3]]) -> Result<(), Failure> {
    let frame = Frame::new(mesh, positions)?;
    let edge_m = mean_edge(mesh, &frame);
    let (mut intersector, mut intersections) = (Intersector::default(), Intersections::default());
    let (mut search, mut found) = (ProximitySearch::default(), Vec::new());
    let (mut best, mut counts) = ([Duration::MAX; 4], [0; 2]);
    for _ in 0..RUNS {
        let cold = timed(|| {
            intersector.clear_cache();
            intersector.intersect(mesh, &frame, &mut intersections);
        });
        let below = [0, 1].map(|which| {
            let time = timed(|| {
                search.find(mesh, &frame, [0.01, 0.1][which] * edge_m, usize::MAX, &mut found);
            });
            counts[which] = found.len();
            time
        });
        let nearest = timed(|| assert!(search.nearest(mesh, &frame).is_some()));
        let times = [cold, below[0], below[1], nearest];
        best = std::array::from_fn(|which| best[which].min(times[which]));
    }
    let [cold, one, ten, nearest] = best.map(milliseconds);
    println!(
        "| {name} | {} | {cold:.2} | {} | {one:.2} | {:.2} | {} | {ten:.2} | {:.2} | {nearest:.2} |",
        mesh.num_faces(),
        counts[0],
        one / cold,
        counts[1],
        ten / cold,
    );
    Ok(())
}

fn mean_edge(mesh: &Mesh, frame: &Frame) -> f64 {
    let lengths = mesh.edge_ids().map(|edge| {
        let [a, b] = mesh.edge(edge).map(|end| frame.position(end));
        (b - a).norm()
    });
    lengths.sum::<f64>() / mesh.num_edges() as f64
}
