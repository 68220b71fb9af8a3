//! What `untangled fix` makes of meshes: iterations, time, distortion; judged by a checker that shares no code with it.
//!
//! ```sh
//! cargo run --release -p untangled-lab --bin fix_table -- [--quality fast|balanced|accurate] [--most N] [--motions N]
//! [--subdivide N] [--no-uvs] [--crumple SQUARES] [--frequency F] [--seed N] [--curve] [--watch] FILE...
//! ```
//!
//! `--subdivide N` splits every triangle in four, N times, before; `--motions N` takes every mesh N times, each under
//! another random rigid motion and scale. `--crumple N` takes a sheet of N x N squares under random waves of up to F
//! periods; `--curve` prints the intersections after each iteration, `--watch` does so on standard error while it
//! works, with the seconds since the start.
#![allow(clippy::print_stdout, reason = "prints a table")]

mod meshes;
mod row;

use std::{env, error::Error};

use meshes::{Shape, crumple, motion, subdivide};
use row::{Row, Show, run};
use untangle::{mesh::Mesh, relax::RelaxSettings};
use untangled_lab::names::named;
use untangled_mesh_io::{concatenate, read_mesh};

/// What the command line asks for.
struct Options {
    settings: RelaxSettings,
    motions: u64,
    levels: u32,
    strip_uvs: bool,
    files: Vec<String>,
    crumples: Vec<u32>,
    frequency: f64,
    seed: u64,
    show: Show,
}

impl Options {
    fn parse(mut arguments: impl Iterator<Item = String>) -> Result<Self, Box<dyn Error>> {
        let mut options = Self {
            settings: RelaxSettings::default(),
            motions: 0,
            levels: 0,
            strip_uvs: false,
            files: Vec::new(),
            crumples: Vec::new(),
            frequency: 1.6,
            seed: 1,
            show: Show::default(),
        };
        while let Some(argument) = arguments.next() {
            let mut value = || arguments.next().ok_or_else(|| format!("{argument} needs a value"));
            match argument.as_str() {
                "--quality" => options.settings.effort = named(&value()?)?,
                "--most" => options.settings.max_iterations = value()?.parse()?,
                "--motions" => options.motions = value()?.parse()?,
                "--subdivide" => options.levels = value()?.parse()?,
                "--no-uvs" => options.strip_uvs = true,
                "--crumple" => options.crumples.push(value()?.parse()?),
                "--frequency" => options.frequency = value()?.parse()?,
                "--seed" => options.seed = value()?.parse()?,
                "--curve" => options.show.curve = true,
                "--watch" => options.show.watch = true,
                _ => options.files.push(argument),
            }
        }
        Ok(options)
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let options = Options::parse(env::args().skip(1))?;
    println!(
        "{:<28} {:>8} {:>6} {:>6} {:>8} {:>8} {:>8} {:>8} {:>8}",
        "mesh", "before", "after", "iter", "s", "edge<", "edge>", "area<", "move/D"
    );
    let mut rows: Vec<Row> = Vec::new();
    for &squares in &options.crumples {
        let (description, positions) = crumple(squares, options.frequency, options.seed);
        let name = format!("crumple {} triangles", 2 * squares * squares);
        rows.push(run(&name, &description, &positions, &options.settings, options.show)?);
    }
    for file in &options.files {
        rows.extend(run_file(file, &options)?);
    }
    print_summary(&rows);
    Ok(())
}

/// The rows of one file: one, or one for each motion.
fn run_file(file: &str, options: &Options) -> Result<Vec<Row>, Box<dyn Error>> {
    let name = file.rsplit('/').next().unwrap_or(file).trim_end_matches(".obj");
    let Ok(read) = read_mesh(file) else {
        println!("{name:<28} can't be read");
        return Ok(Vec::new());
    };
    let world = concatenate(&[read])?;
    let mut shape: Shape = (world.description, world.positions);
    if options.strip_uvs {
        shape.0.uvs = None;
    }
    for _ in 0..options.levels {
        shape = subdivide(&shape);
    }
    let (description, positions) = shape;
    if Mesh::new(description.clone()).is_err() {
        println!("{name:<28} is no mesh");
        return Ok(Vec::new());
    }
    if options.motions == 0 {
        return Ok(vec![run(name, &description, &positions, &options.settings, options.show)?]);
    }
    let moved = |seed| {
        run(&format!("{name} #{seed}"), &description, &motion(seed, &positions), &options.settings, options.show)
    };
    (0..options.motions).map(moved).collect()
}

fn print_summary(rows: &[Row]) {
    let clean = rows.iter().filter(|row| row.after == 0).count();
    #[expect(clippy::cast_precision_loss, reason = "counts of a table")]
    let mean = rows.iter().map(|row| row.iterations as f64).sum::<f64>() / rows.len().max(1) as f64;
    println!("{clean} of {} clean, {mean:.1} iterations on the average", rows.len());
    let mut worst: Vec<f64> =
        rows.iter().map(|row| if row.edges.1.ln() > -row.edges.0.ln() { row.edges.1 } else { row.edges.0 }).collect();
    worst.sort_by(|a, b| a.ln().abs().total_cmp(&b.ln().abs()));
    if let Some(median) = worst.get(worst.len() / 2) {
        println!("median of the worst edge ratios: {median:.3}; {:.3} to {:.3}", worst[0], worst[worst.len() - 1]);
    }
}
