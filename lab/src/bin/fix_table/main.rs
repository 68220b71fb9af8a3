//! What `untangled fix` makes of meshes, and how little it changes them; judged by a checker that shares no code with
//! it.
//!
//! ```sh
//! cargo run --release -p untangled-lab --bin fix_table -- [--quality fast|balanced|accurate] [--most N] [--seconds S]
//! [--one-attempt] [--subdivide N] [--motions N] [--perturb N] [--no-uvs] [--curve] [--watch]
//! [--crumple SQUARES [--frequency F] [--seed N]] [--knots AROUND [--overlap PART]] [--scissors SQUARES] [--over]
//! FILE...
//! ```
//!
//! Columns: faces; edge-face intersections before and after; iterations; mean and largest displacement in percent of
//! the diagonal of the bounding box; least and greatest ratio of an edge's length to that before; least ratio of a
//! face's area; vertices that moved, in percent; processor seconds; the methods in order.
//!
//! `--one-attempt` makes no other attempts where the first ended far from the input. `--subdivide N` splits every
//! triangle in four, N times, before. `--motions N` takes every mesh N times, each under another random rigid motion
//! and scale. `--perturb N` takes it N times more, each vertex moved by up to 1e-12 of the diagonal and every other
//! time under other names of vertices and faces, and prints the least, the median and the greatest value of each
//! column. `--crumple N` takes a sheet of N x N squares under random waves of up to F periods, `--knots N` takes ten
//! knotted tubes of N vertices around, thicker by a part than there is room for, `--scissors N` three folded sheets of
//! N x N squares of which the layers cross each other, `--over` each file with a copy over it that lies too far in by
//! places, in four ways. `--seconds` ends a mesh after so much processor time; `--curve`
//! prints the intersections after each iteration, `--watch` does so on standard error while it works.
#![allow(clippy::print_stdout, reason = "prints a table")]

mod change;
mod garments;
mod meshes;
mod options;
mod row;
mod summary;

use std::{env, error::Error};

use garments::worn_over;
use meshes::{Shape, crumple, knots, motion, perturbed, read, scissors, subdivide};
use options::Options;
use row::Row;
use summary::{print_spread, print_summary};

fn main() -> Result<(), Box<dyn Error>> {
    let options = Options::parse(env::args().skip(1))?;
    println!("{:<32} {}", "mesh", row::header());
    let mut rows: Vec<Row> = Vec::new();
    for &squares in &options.crumples {
        let shape = crumple(squares, options.frequency, options.seed);
        rows.extend(rows_of("crumple", shape, &options));
    }
    for &around in &options.knots {
        for (name, shape) in knots(around, options.overlap) {
            rows.extend(rows_of(name, shape, &options));
        }
    }
    for &squares in &options.scissors {
        for (name, shape) in scissors(squares) {
            rows.extend(rows_of(&name, shape, &options));
        }
    }
    for file in &options.files {
        let name = file.rsplit('/').next().unwrap_or(file).trim_end_matches(".obj");
        match read(file) {
            Ok(shape) if options.over => {
                for (offset, shape) in worn_over(&shape) {
                    rows.extend(rows_of(&format!("{name} {offset}"), shape, &options));
                }
            }
            Ok(shape) => rows.extend(rows_of(name, shape, &options)),
            Err(error) => println!("{name:<32} {error}"),
        }
    }
    print_summary(&rows);
    Ok(())
}

/// The rows of one mesh: one, or one for each motion.
fn rows_of(name: &str, mut shape: Shape, options: &Options) -> Vec<Row> {
    if options.strip_uvs {
        shape.0.uvs = None;
    }
    for _ in 0..options.levels {
        shape = subdivide(&shape);
    }
    if options.motions > 0 {
        let moved = (0..options.motions).map(|seed| (shape.0.clone(), motion(seed, &shape.1)));
        return moved.filter_map(|shape| print_row(name, &shape, options)).collect();
    }
    let row = print_row(name, &shape, options);
    let others = (0..options.perturbations).map(|seed| perturbed(seed, &shape));
    let spread: Vec<Row> = others.filter_map(|shape| options.run.row(&shape.0, &shape.1).ok()).collect();
    print_spread(&spread);
    row.into_iter().chain(spread).collect()
}

fn print_row(name: &str, (description, positions): &Shape, options: &Options) -> Option<Row> {
    match options.run.row(description, positions) {
        Ok(row) => {
            println!("{name:<32} {row}");
            if options.run.curve {
                println!("  {}", row.curve);
            }
            Some(row)
        }
        Err(error) => {
            println!("{name:<32} {error}");
            None
        }
    }
}
