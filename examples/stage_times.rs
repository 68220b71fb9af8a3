//! Time of each stage of the analysis against the number of triangles and of segments.
//!
//! `cargo run --release --example stage_times [LARGEST_RESOLUTION]`: generated sheets of 2 n^2 triangles, hardly bent and crumpled. Times are the
//! least of five frames, after one that builds the tree.

#![allow(clippy::print_stdout, clippy::cast_precision_loss, reason = "prints a table of ratios")]

#[path = "../tests/support/sheet.rs"]
#[allow(dead_code, clippy::unwrap_used, reason = "a part of what the tests use")]
mod sheet;

use std::time::{Duration, Instant};

use untangled::{
    analysis::{Analyser, Stage, StageObserver},
    frame::Frame,
    settings::Settings,
};

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

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let largest: u32 = std::env::args().nth(1).map_or(Ok(500), |text| text.parse())?;
    println!(
        "triangles  state      segments  paths  inside  intersect us  paths us  regions us  ns/triangle  ns/segment (paths + regions)"
    );
    for resolution in [35, 79, 125, 250, 500, 1000].into_iter().filter(|&resolution| resolution <= largest) {
        let crumpled = sheet::crumpled(11, resolution);
        let mesh = crumpled.mesh();
        let bent: Vec<[f64; 3]> = crumpled.uvs.iter().map(|&[u, v]| [u, v, 0.1 * (3.0 * u).sin() * v]).collect();
        for (state, positions) in [("untangled", &bent), ("tangled", &crumpled.positions)] {
            let frame = Frame::new(&mesh, positions)?;
            let mut analyser = Analyser::default();
            let settings = Settings::default();
            let found = analyser.analyse(&mesh, &frame, &settings, &mut ());
            let (segments, paths) = (found.intersections.segments.len(), found.paths.copies.len());
            let inside = found.regions.vertices.len();
            let mut best = [Duration::MAX; 3];
            for _ in 0..5 {
                let mut watch = Stopwatch::default();
                analyser.analyse(&mesh, &frame, &settings, &mut watch);
                for (best, stage) in best.iter_mut().zip(watch.stages) {
                    *best = (*best).min(stage);
                }
            }
            let [intersect, tracing, regions] = best.map(|time| time.as_nanos() as f64);
            println!(
                "{:9}  {state:9}  {segments:8}  {paths:5}  {inside:6}  {:12.0}  {:8.0}  {:10.0}  {:11.1}  {:10.1}",
                mesh.num_faces(),
                intersect / 1e3,
                tracing / 1e3,
                regions / 1e3,
                intersect / mesh.num_faces() as f64,
                (tracing + regions) / segments.max(1) as f64,
            );
        }
    }
    Ok(())
}
