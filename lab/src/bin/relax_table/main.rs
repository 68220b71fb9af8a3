//! Steps to no intersection: quasi-static relaxation with the corrections, without a daemon.
//!
//! ```sh
//! cargo run --release -p untangled-lab --bin relax_table -- [--response rbf|contour|displacement|mask] [--rest
//! uv|input] [--steps N] [--step H] [--stiffness K] [--no-uvs] [--verbose] [--quality fast|balanced|accurate] FILE...
//! ```
//!
//! Each step moves every vertex by its correction and then makes some iterations of position-based dynamics (Müller,
//! Heidelberger, Hennix and Ratcliff 2007) on edge lengths and on the distances across edges, towards the flat sheet
//! (`uv`) or the shape of the input (`input`).
#![allow(clippy::print_stdout, reason = "prints a table")]

mod scene;
mod springs;

use std::{env, error::Error};

use scene::Scene;
use untangle::settings::{Quality, Settings};
use untangled_lab::names::named;

fn main() -> Result<(), Box<dyn Error>> {
    let mut settings = Settings::default();
    let (mut flat, mut most, mut verbose, mut strip_uvs) = (true, 100, false, false);
    let mut files = Vec::new();
    let mut arguments = env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().ok_or_else(|| format!("{argument} needs a value"));
        match argument.as_str() {
            "--response" => settings.response = named(&value()?)?,
            "--quality" => named::<Quality>(&value()?)?.apply(&mut settings),
            "--rest" => flat = value()? == "uv",
            "--steps" => most = value()?.parse()?,
            "--step" => settings.max_step_edge_lengths = value()?.parse()?,
            "--stiffness" => settings.stiffness_per_step2 = value()?.parse()?,
            "--verbose" => verbose = true,
            "--no-uvs" => strip_uvs = true,
            _ => files.push(argument),
        }
    }
    println!(
        "{:<24} {:>8} {:>6} {:>6} {:>6} {:>7} {:>9} {:>9}",
        "scene", "before", "steps", "held", "after", "stretch", "force", "torque"
    );
    for file in files {
        let Some(scene) = Scene::read(&file, flat, strip_uvs)? else {
            println!("{file:<24} can't be used");
            continue;
        };
        let result = scene.run(&settings, most, verbose)?;
        let name = file.rsplit('/').next().unwrap_or(&file).trim_end_matches(".obj");
        println!("{name:<24} {result}");
    }
    Ok(())
}
