//! What corrections do in a simulator that has self-contact of its own: scene by scene, method by method, with controls.
//!
//! ```sh
//! cargo run --release --example response_table -- [--steps N] [--seeds N] [--edge METRES] [--only METHOD] [--verbose] [--markdown] [FILE...]
//! cargo run --release --example response_table -- --markdown > docs/RESPONSE.md
//! ```
//!
//! The host is the simulator of `clients/publisher`, whose contact defends whatever side a vertex is on; the judge is its exact check, which
//! shares no code with the untangler. Files (OBJ) are run with the shape of the file as rest shape, without gravity.
#![expect(clippy::print_stdout, reason = "an example talks to whoever runs it")]

mod support;

use std::{
    env,
    error::Error,
    path::Path,
    sync::Arc,
    time::{Duration, Instant},
};

use support::{
    Knowledge,
    host::{DT_S, Taken, mesh_of},
};
use untangle::{frame::Frame, settings::{Response, Settings}, untangler::Untangler};
use untangled_publisher::{
    check::count_edge_face,
    mesh::Cloth,
    obj,
    scenes::Scene,
    solver::{Parameters, Solver},
};

/// A scene is held when it stays clean for so many steps.
const HELD: usize = 5;
const SCENES: [(&str, &str); 7] = [
    ("bag", "CLOSED"),
    ("tongue", "BB/II"),
    ("curtains", "BI/BI"),
    ("crease", "LL"),
    ("twist", "BLI"),
    ("drop", "EIGHT"),
    ("wedge", "CROSS"),
];

/// What of the corrections a host uses.
#[derive(Clone, Copy)]
struct Method {
    name: &'static str,
    response: Response,
    values: bool,
    mask: bool,
}

const METHODS: [Method; 7] = [
    Method { name: "no response", response: Response::Mask, values: false, mask: false },
    Method { name: "mask only", response: Response::Mask, values: false, mask: true },
    Method { name: "force without mask", response: Response::Rbf, values: true, mask: false },
    Method { name: "force + mask (rbf)", response: Response::Rbf, values: true, mask: true },
    Method { name: "contour + mask", response: Response::Contour, values: true, mask: true },
    Method { name: "displacement + mask", response: Response::Displacement, values: true, mask: true },
    Method { name: "coupled + mask", response: Response::Coupled, values: true, mask: true },
];

/// How one run ended.
struct Run {
    before: usize,
    /// Steps to the first clean state.
    steps: Option<usize>,
    held: bool,
    after: usize,
    /// The edge ratio to rest farthest from 1.
    stretch: f64,
    /// Of analysis and response, all steps that were not clean.
    untangler: Duration,
    busy_steps: usize,
}

fn main() -> Result<(), Box<dyn Error>> {
    let (mut most, mut seeds, mut edge_m, mut markdown, mut verbose) = (200, 1, 0.025, false, false);
    let mut only = String::new();
    let mut files = Vec::new();
    let mut arguments = env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().ok_or_else(|| format!("{argument} needs a value"));
        match argument.as_str() {
            "--steps" => most = value()?.parse()?,
            "--seeds" => seeds = value()?.parse()?,
            "--edge" => edge_m = value()?.parse()?,
            "--only" => only = value()?,
            "--verbose" => verbose = true,
            "--markdown" => markdown = true,
            _ => files.push(argument),
        }
    }
    print_head(markdown, most, edge_m);
    let methods = || METHODS.into_iter().filter(|method| method.name.starts_with(&only));
    if files.is_empty() {
        for (name, path_type) in SCENES {
            let scene: Scene = name.parse()?;
            for seed in 1..=seeds {
                let label =
                    format!("{name} ({path_type})") + &if seeds > 1 { format!(" #{seed}") } else { String::new() };
                for method in methods() {
                    print_row(
                        &label,
                        method.name,
                        &run(scene.build(seed, edge_m), 9.81, method, most, verbose)?,
                        markdown,
                    );
                }
            }
        }
    }
    for file in files {
        let label =
            Path::new(&file).file_stem().map_or_else(|| file.clone(), |stem| stem.to_string_lossy().into_owned());
        for method in methods() {
            match obj::read(Path::new(&file))
                .map_err(Box::from)
                .and_then(|cloth| run(cloth, 0.0, method, most, verbose))
            {
                Ok(run) => print_row(&label, method.name, &run, markdown),
                Err(error) => println!("{label}: {error}"),
            }
        }
    }
    Ok(())
}

fn print_head(markdown: bool, most: usize, edge_m: f64) {
    if !markdown {
        println!(
            "{:<26} {:<20} {:>6} {:>5} {:>5} {:>6} {:>8} {:>8}",
            "scene", "method", "before", "steps", "held", "after", "stretch", "ms/step"
        );
        return;
    }
    println!("# What corrections do in a simulator with self-contact\n");
    println!("Made by `cargo run --release --example response_table -- --markdown > docs/RESPONSE.md`; do not edit.\n");
    println!(
        "Scenes and simulator are those of `clients/publisher`, edges of {edge_m} m, steps of 1/60 s, at most {most}. `before` and `after` are"
    );
    println!(
        "edge-face hits by its exact check, which shares no code with the untangler; `steps` is the number of steps to the first clean state,"
    );
    println!(
        "`held` whether the next {HELD} were clean too, `stretch` the edge ratio to rest that is farthest from 1 at the end, `ms/step` analysis and"
    );
    println!("response of a tangled step, on one machine and to be compared within the table only.\n");
    println!("| scene | method | before | steps | held | after | stretch | ms/step |");
    println!("|---|---|---|---|---|---|---|---|");
}

fn print_row(scene: &str, method: &str, run: &Run, markdown: bool) {
    let steps = run.steps.map_or("-".into(), |steps| steps.to_string());
    let held = match (run.steps, run.held) {
        (None, _) => "-",
        (_, true) => "yes",
        (_, false) => "no",
    };
    let ms = 1e3 * run.untangler.as_secs_f64() / f64::from(u32::try_from(run.busy_steps.max(1)).unwrap_or(u32::MAX));
    let Run { before, after, stretch, .. } = run;
    if markdown {
        println!("| {scene} | {method} | {before} | {steps} | {held} | {after} | {stretch:.2} | {ms:.2} |");
    } else {
        println!("{scene:<26} {method:<20} {before:>6} {steps:>5} {held:>5} {after:>6} {stretch:>8.2} {ms:>8.2}");
    }
}

fn run(cloth: Cloth, gravity_m_s2: f64, method: Method, most: usize, verbose: bool) -> Result<Run, Box<dyn Error>> {
    let parameters = Parameters::of_cloth(&cloth, gravity_m_s2);
    let mut solver = Solver::new(cloth, parameters);
    let mesh = Arc::new(mesh_of(solver.cloth(), solver.masses_kg(), Knowledge::Uvs)?);
    let settings = Settings { response: method.response, ..Settings::default() };
    let mut untangler = Untangler::new(mesh, settings)?;
    let mut run =
        Run { before: 0, steps: None, held: true, after: 0, stretch: 1.0, untangler: Duration::ZERO, busy_steps: 0 };
    let mut taken = Taken::default();
    for step in 0..=most {
        let points = solver.cloth().points();
        run.after = count_edge_face(&points, &solver.cloth().triangles)?;
        if step == 0 {
            run.before = run.after;
        }
        match run.steps {
            None if run.after == 0 => run.steps = Some(step),
            Some(_) if run.after > 0 => run.held = false,
            _ => {}
        }
        if step == most || run.steps.is_some_and(|first| step >= first + HELD) {
            break;
        }
        let frame = Frame::new(untangler.mesh(), &points)?;
        let begin = Instant::now();
        let outcome = untangler.process(&frame, &mut ());
        let corrections = outcome.corrections;
        if run.after > 0 {
            run.untangler += begin.elapsed();
            run.busy_steps += 1;
        }
        if verbose {
            let pairs = outcome.analysis.paths.pairs.iter().map(|pair| (pair.pair_type, pair.num_segments));
            println!("  {step:>4} {:>5} {:?}", run.after, pairs.collect::<Vec<_>>());
        }
        if method.values {
            taken.take_values(corrections, solver.masses_kg(), method.response);
        }
        if method.mask {
            taken.take_mask(corrections);
        }
        solver.step(DT_S, taken.help());
    }
    run.stretch = solver.cloth().worst_edge_ratio();
    Ok(run)
}
