//! How fast frames are, as tables in Markdown; `docs/SPEED.md` is made by it.
//!
//! ```sh
//! cargo run --release --example speed -- [--largest RESOLUTION] [--only TABLE] > docs/SPEED.md
//! ```
//!
//! Tables: search, fall (where ../shared/data is), far, meshlib (with `MESHLIB_PYTHON=python` where that has the packages meshlib and numpy), paper, meshes (where ../shared/data is), growth, cores, scenes.
//! Generated sheets of 2 n^2 triangles: n is 35, 125, 250, 500 and 1000, up to the one given (1000). Times are of the processor, not of the clock on
//! the wall, on one thread but where two are named; contenders take turns, and the least of their times counts.

#![allow(clippy::print_stdout, clippy::cast_precision_loss, reason = "prints tables of ratios")]

mod cores;
mod fall;
mod far;
mod folded;
mod frames;
mod meshes;
mod meshlib;
mod scenes;
mod search;

#[path = "../../tests/support/npz.rs"]
mod npz;
#[path = "../../tests/support/sheet.rs"]
#[allow(dead_code, clippy::unwrap_used, reason = "a part of what the tests use")]
mod sheet;

use std::time::Duration;

use cpu_time::ThreadTime;

/// So that it may come from a pool of threads.
type Failure = Box<dyn std::error::Error + Send + Sync>;

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
    println!(
        "Made by `cargo run --release --example speed > docs/SPEED.md`; do not edit. Times are of one busy machine's processor: read the ratios. \
         What a frame costs more through the daemon, beside a socket, says `FAULTS.md` (`cargo run --release --example soak -- round-trip`)."
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

/// Processor time of a call on this thread.
fn timed(work: impl FnOnce()) -> Duration {
    let start = ThreadTime::now();
    work();
    start.elapsed()
}

fn milliseconds(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}

fn header(columns: &[&str]) {
    println!("| {} |\n|{}", columns.join(" | "), "---|".repeat(columns.len()));
}

/// A sheet that is hardly bent.
fn bent(sheet: &sheet::Sheet) -> Vec<[f64; 3]> {
    sheet.uvs.iter().map(|&[u, v]| [u, v, 0.1 * (3.0 * u).sin() * v]).collect()
}

/// The same positions a little later: all of the sheet has moved on by many edges, and within it waves of a hundredth of an edge run.
fn later(sheet: &sheet::Sheet, positions: &[[f64; 3]], resolution: u32, number: u32) -> Vec<[f64; 3]> {
    let (edge, time) = (1.0 / f64::from(resolution), f64::from(number));
    let moved = |(&[x, y, z], &[u, _]): (&[f64; 3], &[f64; 2])| {
        [x, y + 5.0 * edge * time, z + 0.01 * edge * (0.3 * time + 7.0 * u).sin()]
    };
    positions.iter().zip(&sheet.uvs).map(moved).collect()
}
