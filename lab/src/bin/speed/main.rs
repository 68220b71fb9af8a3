//! How fast frames are, as tables in Markdown; `docs/results/speed.md` is made by it.
//!
//! ```sh
//! cargo run --release -p untangled-lab --bin speed -- [--largest RESOLUTION] [--only TABLE] > docs/results/speed.md
//! ```
//!
//! Tables: search, fall (where ../shared/data is), far, meshlib (with `MESHLIB_PYTHON=python` where that has the
//! packages meshlib and numpy), paper, meshes (where ../shared/data is), growth, cores, scenes. Generated sheets of 2
//! n^2 triangles: n is 35, 125, 250, 500 and 1000, up to the one given (1000). Times are of the processor, not of the
//! clock on the wall, on one thread but where two are named; contenders take turns, and the least of their times
//! counts.

#![allow(clippy::print_stdout, clippy::cast_precision_loss, reason = "prints tables of ratios")]

mod cores;
mod fall;
mod far;
mod frames;
mod meshes;
mod meshlib;
mod scenes;
mod search;

use untangled_lab::Failure;
use untangled_lab::table::print_text;

const RESOLUTIONS: [u32; 5] = [35, 125, 250, 500, 1000];

fn main() -> Result<(), Failure> {
    let (mut largest, mut only) = (1000, None);
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match (argument.as_str(), arguments.next()) {
            ("--largest", Some(value)) => largest = value.parse()?,
            ("--only", Some(value)) => only = Some(value),
            _ => return Err(format!("{argument}: only --largest RESOLUTION and --only TABLE are known").into()),
        }
    }
    let resolutions: Vec<u32> = RESOLUTIONS.into_iter().filter(|&resolution| resolution <= largest).collect();
    println!("# How fast frames are\n");
    print_text(
        "Made by `cargo run --release -p untangled-lab --bin speed > docs/results/speed.md`; do not edit. Times are of \
         one busy machine's processor: read the ratios. What a frame costs more through the daemon, beside a socket, \
         is in `faults.md` (`cargo run --release -p untangled-lab --bin soak -- round-trip`).",
    );
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    let wants = |table: &str| only.as_deref().is_none_or(|only| only == table);
    if wants("search") {
        one.install(|| search::table(&resolutions))?;
    }
    if wants("fall") {
        one.install(fall::table)?;
    }
    if wants("far") {
        one.install(far::table)?;
    }
    if wants("meshlib") {
        one.install(|| meshlib::table(&resolutions))?;
    }
    if wants("paper") {
        one.install(frames::paper_table)?;
    }
    if wants("meshes") {
        one.install(meshes::table)?;
    }
    if wants("growth") {
        one.install(frames::growth_table)?;
    }
    if wants("cores") {
        cores::table(&resolutions)?;
    }
    if wants("scenes") {
        one.install(scenes::table)?;
    }
    Ok(())
}
