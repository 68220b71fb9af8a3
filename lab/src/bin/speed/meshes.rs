//! Whole frames of real meshes, where they are.

use std::{
    fs,
    path::{Path, PathBuf},
};

use untangle::mesh::Mesh;
use untangled_lab::{
    Failure,
    clock::milliseconds,
    table::{print_header, print_text},
};
use untangled_mesh_io::{concatenate, read_mesh};
use untangled_testkit::files::shared;

use crate::frames::measure;

pub(crate) fn table() -> Result<(), Failure> {
    println!("\n## Real meshes\n");
    let Some(folder) = shared("data") else {
        println!("Left out: there is no folder ../shared/data beside the checkout.");
        return Ok(());
    };
    let mut files: Vec<PathBuf> = fs::read_dir(folder)?.flatten().map(|entry| entry.path()).collect();
    files.retain(|file| file.extension().is_some_and(|kind| kind == "obj" || kind == "ply"));
    files.sort();
    print_text(
        "The meshes of ../shared/data as they are, on one thread; milliseconds of the stages of a cold frame, of all \
         of it, and of one that follows another in which waves of a hundredth of an edge run through the cloth; `next \
         cold` is that same frame, cold: the waves change what intersects.\n",
    );
    print_header(&[
        "mesh",
        "#Tri",
        "#Paths",
        "#Seg",
        "#In",
        "search",
        "paths",
        "regions",
        "targets",
        "response",
        "all",
        "next",
        "next cold",
    ]);
    for file in files {
        row(&file)?;
    }
    Ok(())
}

fn row(file: &Path) -> Result<(), Failure> {
    let world = concatenate(&[read_mesh(file)?])?;
    let mesh = Mesh::new(world.description)?;
    let num_faces = mesh.num_faces();
    let edge = mean_edge(&mesh, &world.positions);
    let found = measure(mesh, &world.positions, edge, 3)?;
    let stages = found.stages.map(|time| format!("{:.2}", milliseconds(time)));
    println!(
        "| {} | {num_faces} | {} | {} | {} | {} | {:.2} | {:.2} | {:.2} |",
        file.file_stem().unwrap_or_default().display(),
        found.num_paths,
        found.num_segments,
        found.num_inside,
        stages.join(" | "),
        milliseconds(found.whole),
        milliseconds(found.next),
        milliseconds(found.next_cold),
    );
    Ok(())
}

fn mean_edge(mesh: &Mesh, positions: &[[f64; 3]]) -> f64 {
    let lengths = mesh.edge_ids().map(|edge| {
        let [a, b] = mesh.edge(edge).map(|end| positions[end.index()]);
        (0..3).map(|axis| (b[axis] - a[axis]).powi(2)).sum::<f64>().sqrt()
    });
    lengths.sum::<f64>() / mesh.num_edges() as f64
}
