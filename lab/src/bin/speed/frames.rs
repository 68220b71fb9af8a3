//! Whole frames, stage by stage.

use std::{sync::Arc, time::Duration};

use cpu_time::ThreadTime;
use untangle::{
    frame::Frame,
    mesh::Mesh,
    settings::Settings,
    stage::{Stage, StageObserver},
    untangler::Untangler,
};
use untangled_lab::{
    Failure,
    clock::milliseconds,
    table::{print_header, print_text},
};
use untangled_testkit::generate::{
    Sheet, crumpled_further,
    furrows::{Furrows, folded},
};

/// Processor time of each stage.
#[derive(Default)]
pub(crate) struct Stopwatch {
    running: Option<(usize, ThreadTime)>,
    pub(crate) stages: [Duration; 5],
}

impl StageObserver for Stopwatch {
    fn begin(&mut self, stage: Stage) {
        self.end();
        self.running = Some((stage as usize, ThreadTime::now()));
    }

    fn end(&mut self) {
        if let Some((slot, since)) = self.running.take() {
            self.stages[slot] += since.elapsed();
        }
    }
}

/// Least times of the stages of one cold frame, and of all of it; and of all of a frame that follows another one, in
/// which the cloth has moved.
pub(crate) struct Measured {
    pub(crate) num_paths: usize,
    pub(crate) num_segments: usize,
    pub(crate) num_inside: usize,
    pub(crate) stages: [Duration; 5],
    pub(crate) whole: Duration,
    pub(crate) next: Duration,
    /// Those of the same following frames, each cold.
    pub(crate) next_cold: Duration,
}

/// Measures cold frames, and frames that follow one another, in which waves of a hundredth of an edge run
/// through the cloth.
pub(crate) fn measure(mesh: Mesh, positions: &[[f64; 3]], edge: f64, num_rounds: usize) -> Result<Measured, Failure> {
    let mesh = Arc::new(mesh);
    let frame = Frame::new(&mesh, positions)?;
    // A frame from which nothing can be kept.
    let elsewhere: Vec<[f64; 3]> = positions.iter().map(|point| point.map(|x| 2.0 * x)).collect();
    let elsewhere = Frame::new(&mesh, &elsewhere)?;
    let mut untangler = Untangler::new(mesh.clone(), Settings::default())?;
    let mut best = Measured {
        num_paths: 0,
        num_segments: 0,
        num_inside: 0,
        stages: [Duration::MAX; 5],
        whole: Duration::MAX,
        next: Duration::MAX,
        next_cold: Duration::MAX,
    };
    for _ in 0..num_rounds {
        untangler.process(&elsewhere, &mut ());
        let mut watch = Stopwatch::default();
        let start = ThreadTime::now();
        let outcome = untangler.process(&frame, &mut watch);
        best.whole = best.whole.min(start.elapsed());
        best.num_paths = outcome.analysis.paths.pairs.len();
        best.num_segments = outcome.analysis.intersections.segments.len();
        best.num_inside = outcome.analysis.regions.vertices.len();
        best.stages = std::array::from_fn(|stage| best.stages[stage].min(watch.stages[stage]));
    }
    let wave = |number: u32| -> Result<Frame, Failure> {
        let time = f64::from(number);
        let moved = |&[x, y, z]: &[f64; 3]| [x, y, z + 0.01 * edge * (0.3 * time + 0.7 * x / edge).sin()];
        Ok(Frame::new(&mesh, &positions.iter().map(moved).collect::<Vec<_>>())?)
    };
    for number in 0..8 {
        let frame = wave(number)?;
        let start = ThreadTime::now();
        untangler.process(&frame, &mut ());
        if number >= 3 {
            best.next = best.next.min(start.elapsed());
        }
    }
    // The same frames, each cold.
    for number in 3..8 {
        let frame = wave(number)?;
        untangler.process(&elsewhere, &mut ());
        let start = ThreadTime::now();
        untangler.process(&frame, &mut ());
        best.next_cold = best.next_cold.min(start.elapsed());
    }
    Ok(best)
}

/// The same for a sheet.
pub(crate) fn measure_sheet(sheet: &Sheet, num_rounds: usize) -> Result<Measured, Failure> {
    let edge = (2.0 / sheet.faces.len() as f64).sqrt();
    measure(sheet.mesh(), &sheet.positions, edge, num_rounds)
}

/// The states of the paper's Table 1, as near as generated sheets come to them.
pub(crate) fn paper_table() -> Result<(), Failure> {
    println!("\n## The paper's Table 1\n");
    print_text(
        "Generated states with about the paper's numbers, in its columns: triangles, paths, segments and vertices \
         inside; milliseconds for segments, paths (with regions) and fits (with targets). `all` is a whole cold frame, \
         forces included, `next` one that follows another; `paper` the sum of its three columns on a Pentium 4 of 3 \
         GHz. Folded sheets hang through themselves in narrow furrows, as many as the paper has paths; crumpled ones \
         have wider and fewer regions, of all types.\n",
    );
    print_header(&[
        "state",
        "#Tri",
        "#Paths",
        "#Seg",
        "#In",
        "Seg",
        "Path",
        "RBF",
        "all",
        "next",
        "paper #Paths",
        "paper #Seg",
        "paper #In",
        "paper",
        "paper / all",
    ]);
    let furrows = |resolution, rows, columns, along, across| {
        ("folded", folded(1, resolution, Furrows { rows, columns, along, across }))
    };
    let crumple =
        |seed, resolution, frequency, further| ("crumpled", crumpled_further(seed, resolution, frequency, further));
    // Each with the paper's paths, segments, inside, and the sum of its milliseconds.
    for ((state, sheet), paper) in [
        (crumple(1, 35, 1.5, 2), [4, 154, 147, 32]),
        (furrows(35, 4, 6, 2.4, 1.5), [23, 1976, 827, 391]),
        (crumple(2, 35, 2.5, 12), [23, 1976, 827, 391]),
        (furrows(125, 2, 4, 3.0, 1.0), [8, 284, 147, 375]),
        (furrows(125, 6, 5, 9.0, 1.1), [30, 4540, 1515, 7906]),
        (crumple(2, 125, 2.5, 12), [30, 4540, 1515, 7906]),
    ] {
        paper_row(state, &sheet, paper)?;
    }
    Ok(())
}

fn paper_row(state: &str, sheet: &Sheet, paper: [u32; 4]) -> Result<(), Failure> {
    let found = measure_sheet(sheet, 12)?;
    let [segments, paths, regions, fits, _] = found.stages;
    let all = milliseconds(found.whole);
    println!(
        "| {state} | {} | {} | {} | {} | {:.2} | {:.2} | {:.2} | {all:.2} | {:.2} | {} | {} | {} | {} | {:.0} |",
        sheet.faces.len(),
        found.num_paths,
        found.num_segments,
        found.num_inside,
        milliseconds(segments),
        milliseconds(paths + regions),
        milliseconds(fits),
        milliseconds(found.next),
        paper[0],
        paper[1],
        paper[2],
        paper[3],
        f64::from(paper[3]) / all,
    );
    Ok(())
}

/// Times against the number of paths.
pub(crate) fn growth_table() -> Result<(), Failure> {
    println!("\n## Growth with the number of paths\n");
    print_text(
        "One sheet of 31,250 triangles, crumpled more and more. Microseconds of a stage for what it works on.\n",
    );
    print_header(&[
        "paths",
        "segments",
        "inside",
        "search ms",
        "paths us/segment",
        "regions us/(segment + inside)",
        "targets us/(segment + inside)",
        "forces us/(segment + inside)",
        "all ms",
    ]);
    for (seed, frequency, further) in [(2, 1.5, 0), (2, 2.5, 3), (1, 4.0, 0), (1, 6.0, 12)] {
        let sheet = crumpled_further(seed, 125, frequency, further);
        let found = measure_sheet(&sheet, 5)?;
        let [search, paths, regions, targets, forces] = found.stages.map(milliseconds);
        let (segments, points) = (found.num_segments as f64, (found.num_segments + found.num_inside) as f64);
        println!(
            "| {} | {} | {} | {search:.2} | {:.3} | {:.3} | {:.3} | {:.3} | {:.2} |",
            found.num_paths,
            found.num_segments,
            found.num_inside,
            1e3 * paths / segments,
            1e3 * regions / points,
            1e3 * targets / points,
            1e3 * forces / points,
            milliseconds(found.whole),
        );
    }
    Ok(())
}
