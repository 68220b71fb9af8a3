//! Time of each stage of the analysis against the number of triangles and of segments, as a table in Markdown.
//!
//! ```sh
//! cargo run --release --example stage_times -- [--no-uvs] [LARGEST_RESOLUTION]
//! ```
//!
//! Generated sheets of 2 n^2 triangles, hardly bent and crumpled: n is 35, 79, 125, 250, 500 and 1000, up to the one given (500). Times
//! are the least of five frames, after one that builds the tree. Without texture coordinates the discs of folded paths are unfolded.

#![allow(clippy::print_stdout, clippy::cast_precision_loss, reason = "prints a table of ratios")]

#[path = "../tests/support/sheet.rs"]
#[allow(dead_code, clippy::unwrap_used, reason = "a part of what the tests use")]
mod sheet;

use std::time::{Duration, Instant};

use untangle::{analysis::Analyser, stage::{Stage, StageObserver}, frame::Frame, mesh::Mesh, settings::Settings};

/// Durations of intersect, paths and regions.
#[derive(Default)]
struct Stopwatch {
    running: Option<(usize, Instant)>,
    stages: [Duration; 3],
}

impl StageObserver for Stopwatch {
    fn begin(&mut self, stage: Stage) {
        self.end();
        let slot = match stage {
            Stage::Intersect => 0,
            Stage::Paths => 1,
            _ => 2,
        };
        self.running = Some((slot, Instant::now()));
    }

    fn end(&mut self) {
        if let Some((slot, since)) = self.running.take() {
            self.stages[slot] += since.elapsed();
        }
    }
}

const RESOLUTIONS: [u32; 6] = [35, 79, 125, 250, 500, 1000];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut largest = 500;
    let mut with_uvs = true;
    for argument in std::env::args().skip(1) {
        match argument.as_str() {
            "--no-uvs" => with_uvs = false,
            number => largest = number.parse()?,
        }
    }
    let columns = [
        "triangles",
        "state",
        "segments",
        "paths",
        "inside",
        "intersect us",
        "paths us",
        "regions us",
        "intersect ns/triangle",
        "paths ns/segment",
        "regions ns/(segment + inside)",
    ];
    println!("| {} |\n|{}", columns.join(" | "), "---|".repeat(columns.len()));
    for resolution in RESOLUTIONS.into_iter().filter(|&resolution| resolution <= largest) {
        let crumpled = sheet::crumpled(11, resolution);
        let mesh = if with_uvs { crumpled.mesh() } else { crumpled.bare_mesh() };
        let bent: Vec<[f64; 3]> = crumpled.uvs.iter().map(|&[u, v]| [u, v, 0.1 * (3.0 * u).sin() * v]).collect();
        for (state, positions) in [("untangled", &bent), ("tangled", &crumpled.positions)] {
            row(&mesh, state, &Frame::new(&mesh, positions)?);
        }
    }
    Ok(())
}

fn row(mesh: &Mesh, state: &str, frame: &Frame) {
    let mut analyser = Analyser::default();
    let settings = Settings::default();
    let found = analyser.analyse(mesh, frame, &settings, &mut ());
    let (segments, paths) = (found.intersections.segments.len(), found.paths.copies.len());
    let inside = found.regions.vertices.len();
    let mut best = [Duration::MAX; 3];
    for _ in 0..5 {
        let mut watch = Stopwatch::default();
        analyser.clear_cache();
        analyser.analyse(mesh, frame, &settings, &mut watch);
        for (best, stage) in best.iter_mut().zip(watch.stages) {
            *best = (*best).min(stage);
        }
    }
    let [intersect, tracing, regions] = best.map(|time| time.as_nanos() as f64);
    let per = |time: f64, count: usize| if count > 0 { format!("{:.0}", time / count as f64) } else { "-".into() };
    println!(
        "| {} | {state} | {segments} | {paths} | {inside} | {:.0} | {:.0} | {:.0} | {} | {} | {} |",
        mesh.num_faces(),
        intersect / 1e3,
        tracing / 1e3,
        regions / 1e3,
        per(intersect, mesh.num_faces()),
        per(tracing, segments),
        per(regions, if segments > 0 { segments + inside } else { 0 }),
    );
}
