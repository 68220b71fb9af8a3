//! Meshes split at random edges beside the same meshes unsplit, as `docs/results/seams.md`.
//!
//! ```sh
//! cargo run --release -p untangled-lab --bin seam_table > docs/results/seams.md
//! ```
//!
//! All meshes of `../shared/data` and `../shared/scenes`; nothing is printed without them.

#![allow(clippy::print_stdout, reason = "prints a document")]

use std::{
    fs,
    path::{Path, PathBuf},
};

use untangle::{
    analysis::{Analysis, analyse},
    frame::Frame,
    mesh::{Mesh, MeshDescription},
    weld::Weld,
};
use untangled_lab::{
    Failure,
    table::{print_header, print_text},
};
use untangled_mesh_io::{concatenate, read_mesh};
use untangled_testkit::{
    files::shared,
    generate::{Split, split_at_edges},
    judge::digest::{Digest, Feed},
};

/// Parts of the edges that are cut, and seeds.
const CUTS: [(f64, u64); 4] = [(0.02, 1), (0.3, 2), (0.3, 3), (1.0, 4)];

fn main() -> Result<(), Failure> {
    let (Some(data), Some(scenes)) = (shared("data"), shared("scenes")) else { return Ok(()) };
    print_text(
        "# Seams\n\n\
         Does a mesh whose vertices are split at edges, as exporters do where texture coordinates differ, give the \
         same answer as before? Made by\n\n\
         ```sh\n\
         cargo run --release -p untangled-lab --bin seam_table > docs/results/seams.md\n\
         ```\n\n\
         over the meshes of a folder `../shared` beside the checkout. Each is cut at random edges: 2 %, twice 30 %, \
         and all of them, which leaves triangles without a common vertex. `pairs`: intersecting faces of the mesh, and \
         `unwelded`: of the one cut at 2 % if nothing were welded. `split`: vertices that the cuts add. `same`: \
         whether the welded mesh has the same faces and positions, and its analysis (intersections, paths, inside \
         regions) the same bits.\n",
    );
    print_header(&["mesh", "#Tri", "pairs", "unwelded", "split", "same"]);
    let (mut num_same, mut num_cuts, mut others) = (0, 0, Vec::new());
    for file in meshes(&data)?.into_iter().chain(meshes(&scenes)?) {
        let name = file.file_stem().unwrap_or_default().display().to_string();
        match row(&file) {
            Ok((line, same)) => {
                println!("| {name} | {line} |");
                num_same += same.iter().filter(|same| **same).count();
                num_cuts += same.len();
                if same.contains(&false) {
                    others.push(format!("`{name}`"));
                }
            }
            Err(reason) => {
                let reason = reason.to_string().replace(&file.display().to_string(), "line");
                println!("| {name} | refused: {reason} | | | | |");
            }
        }
    }
    let others = if others.is_empty() { "none".to_owned() } else { others.join(", ") };
    print_text(&format!(
        "\n{num_same} of {num_cuts} cut meshes give the same answer; with others: {others}. Where two sheets lie in \
         one place along edges inside of both, a cut makes boundaries of these edges, and places do not tell any more \
         which of them belong to each other."
    ));
    Ok(())
}

/// The mesh files of a folder, by name.
fn meshes(folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    let mut files: Vec<PathBuf> = fs::read_dir(folder)?.flatten().map(|entry| entry.path()).collect();
    files.retain(|file| file.extension().is_some_and(|kind| kind == "obj" || kind == "ply"));
    files.sort();
    Ok(files)
}

/// The cells of a mesh, and for each cut whether the answer is the same.
fn row(file: &Path) -> Result<(String, Vec<bool>), Failure> {
    let world = concatenate(&[read_mesh(file)?])?;
    let (faces, positions) = (&world.description.faces, &world.positions);
    // Nothing is cut: vertices without a face are left out.
    let whole = split_at_edges(faces, positions, 0.0, 0);
    let expected = Answer::of(&whole, true)?;
    let (mut split, mut same, mut unwelded) = (Vec::new(), Vec::new(), 0);
    for (part, seed) in CUTS {
        let cut = split_at_edges(faces, positions, part, seed);
        if split.is_empty() {
            unwelded = Answer::of(&cut, false)?.num_pairs;
        }
        let answer = Answer::of(&cut, true)?;
        split.push((cut.positions.len() - whole.positions.len()).to_string());
        same.push(answer == expected);
    }
    let words = match same.iter().filter(|same| **same).count() {
        count if count == same.len() => "yes".to_owned(),
        count => format!("{count} of {}", same.len()),
    };
    let cells =
        [faces.len().to_string(), expected.num_pairs.to_string(), unwelded.to_string(), split.join(", "), words];
    Ok((cells.join(" | "), same))
}

/// What is compared.
#[derive(PartialEq)]
struct Answer {
    faces: Vec<[u32; 3]>,
    places: Vec<[u64; 3]>,
    num_pairs: usize,
    analysis: u64,
}

impl Answer {
    /// The answer about a mesh, its seams welded or not.
    fn of(split: &Split, is_welded: bool) -> Result<Self, Failure> {
        let description = MeshDescription {
            num_vertices: split.positions.len(),
            faces: split.faces.clone(),
            ..MeshDescription::default()
        };
        let weld = if is_welded {
            Weld::find(&description, &split.positions, &[], 0.0)?
        } else {
            Weld::none(split.positions.len())
        };
        let (description, positions) = (weld.describe(&description), weld.gather(&split.positions));
        let faces = description.faces.clone();
        let mesh = Mesh::new(description)?;
        let analysis = analyse(&mesh, &Frame::new(&mesh, &positions)?);
        let mut digest = Digest::default();
        analysis.feed(&mut digest);
        let Analysis { intersections, .. } = &analysis;
        let places = positions.iter().map(|place| place.map(f64::to_bits)).collect();
        Ok(Self { faces, places, num_pairs: intersections.segments.len(), analysis: digest.0 })
    }
}
