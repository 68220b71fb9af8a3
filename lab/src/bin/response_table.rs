//! What corrections do in a simulator that has self-contact of its own: scene by scene, method by method, with
//! controls.
//!
//! ```sh
//! cargo run --release -p untangled-lab --bin response_table -- [--steps N] [--seeds N] [--edge METRES] [--only METHOD]
//!     [--rings N] [--lag N] [--verbose] [--markdown] [FILE...]
//! cargo run --release -p untangled-lab --bin response_table -- --markdown > docs/results/response.md
//! ```
//!
//! The host is the simulator of `clients/publisher`, whose contact keeps each vertex on its side, right or wrong; the
//! judge is its exact check, which shares no code with the untangler. Files (OBJ) are run with the shape of the file as
//! rest shape, without gravity.
#![allow(clippy::print_stdout, reason = "prints a table")]

use std::{
    collections::VecDeque,
    env,
    error::Error,
    path::Path,
    sync::Arc,
    time::{Duration, Instant},
};

use untangle::{
    frame::Frame,
    respond::Corrections,
    settings::{Response, Settings},
    untangler::Untangler,
};
use untangled_checker::count_edge_face;
use untangled_lab::host::{DT_S, Taken, mesh_of};
use untangled_lab::table::print_text;
use untangled_publisher::{
    mesh::Cloth,
    obj,
    scenes::Scene,
    solver::{Parameters, Solver},
};
use untangled_testkit::generate::mirrored::Knowledge;

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
    off: Off,
}

/// Which contacts a host switches off.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Off {
    Nothing,
    Mask,
    Labels,
}

impl Method {
    /// Takes what a host uses of a correction.
    fn take(&self, taken: &mut Taken, corrections: &Corrections, masses_kg: &[f64]) {
        if self.values {
            taken.take_values(corrections, masses_kg, self.response);
        }
        match self.off {
            Off::Nothing => {}
            Off::Mask => taken.take_mask(corrections),
            Off::Labels => taken.take_labels(corrections),
        }
    }
}

const METHODS: [Method; 11] = [
    Method { name: "no response", response: Response::Mask, values: false, off: Off::Nothing },
    Method { name: "mask only", response: Response::Mask, values: false, off: Off::Mask },
    Method { name: "force without mask", response: Response::Rbf, values: true, off: Off::Nothing },
    Method { name: "force + mask (rbf)", response: Response::Rbf, values: true, off: Off::Mask },
    Method { name: "contour + mask", response: Response::Contour, values: true, off: Off::Mask },
    Method { name: "displacement + mask", response: Response::Displacement, values: true, off: Off::Mask },
    Method { name: "coupled + mask", response: Response::Coupled, values: true, off: Off::Mask },
    Method { name: "force + labels (rbf)", response: Response::Rbf, values: true, off: Off::Labels },
    Method { name: "contour + labels", response: Response::Contour, values: true, off: Off::Labels },
    Method { name: "displacement + labels", response: Response::Displacement, values: true, off: Off::Labels },
    Method { name: "coupled + labels", response: Response::Coupled, values: true, off: Off::Labels },
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

/// What the command line asks for.
struct Options {
    most: usize,
    seeds: u64,
    edge_m: f64,
    /// Width of the mask round the paths.
    rings: Option<u32>,
    /// Steps by which a correction comes late.
    lag: usize,
    only: String,
    markdown: bool,
    verbose: bool,
    files: Vec<String>,
}

impl Options {
    fn parse(mut arguments: impl Iterator<Item = String>) -> Result<Self, Box<dyn Error>> {
        let (only, files) = (String::new(), Vec::new());
        let mut options = Self {
            most: 200,
            seeds: 1,
            edge_m: 0.025,
            rings: None,
            lag: 0,
            only,
            markdown: false,
            verbose: false,
            files,
        };
        while let Some(argument) = arguments.next() {
            let mut value = || arguments.next().ok_or_else(|| format!("{argument} needs a value"));
            match argument.as_str() {
                "--steps" => options.most = value()?.parse()?,
                "--seeds" => options.seeds = value()?.parse()?,
                "--edge" => options.edge_m = value()?.parse()?,
                "--rings" => options.rings = Some(value()?.parse()?),
                "--lag" => options.lag = value()?.parse()?,
                "--only" => options.only = value()?,
                "--verbose" => options.verbose = true,
                "--markdown" => options.markdown = true,
                _ => options.files.push(argument),
            }
        }
        Ok(options)
    }

    fn methods(&self) -> impl Iterator<Item = Method> {
        METHODS.into_iter().filter(|method| method.name.starts_with(&self.only))
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let options = Options::parse(env::args().skip(1))?;
    print_head(options.markdown, options.most, options.edge_m);
    if options.files.is_empty() {
        return run_scenes(&options);
    }
    for file in &options.files {
        let label =
            Path::new(file).file_stem().map_or_else(|| file.clone(), |stem| stem.to_string_lossy().into_owned());
        for method in options.methods() {
            let cloth = obj::read(Path::new(file)).map_err(Box::from);
            match cloth.and_then(|cloth| run(cloth, 0.0, method, &options)) {
                Ok(run) => print_row(&label, method.name, &run, options.markdown),
                Err(error) => println!("{label}: {error}"),
            }
        }
    }
    Ok(())
}

fn run_scenes(options: &Options) -> Result<(), Box<dyn Error>> {
    for (name, path_type) in SCENES {
        let scene: Scene = name.parse()?;
        for seed in 1..=options.seeds {
            let number = if options.seeds > 1 { format!(" #{seed}") } else { String::new() };
            let label = format!("{name} ({path_type}){number}");
            for method in options.methods() {
                let cloth = scene.build(seed, options.edge_m);
                let run = run(cloth, 9.81, method, options)?;
                print_row(&label, method.name, &run, options.markdown);
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
    print_text(
        "# What corrections do in a simulator with self-contact\n\nMade by `cargo run --release -p untangled-lab --bin \
         response_table -- --markdown > docs/results/response.md`; do not edit.\n",
    );
    print_text(&format!(
        "Scenes and simulator are those of `clients/publisher`, edges of {edge_m} m, steps of 1/60 s, at most {most}. \
         `before` and `after` are edge-face hits by its exact check, which shares no code with the untangler; `steps` \
         is the number of steps to the first clean state, `held` whether the next {HELD} were clean too, `stretch` \
         the edge ratio to rest that is farthest from 1 at the end, `ms/step` analysis and response of a tangled \
         step, on one machine and to be compared within the table only.\n"
    ));
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

impl Run {
    fn new() -> Self {
        Self { before: 0, steps: None, held: true, after: 0, stretch: 1.0, untangler: Duration::ZERO, busy_steps: 0 }
    }

    /// Takes in whether a step's state is clean.
    fn count_steps(&mut self, step: usize) {
        if step == 0 {
            self.before = self.after;
        }
        match self.steps {
            None if self.after == 0 => self.steps = Some(step),
            Some(_) if self.after > 0 => self.held = false,
            _ => {}
        }
    }
}

fn run(cloth: Cloth, gravity_m_s2: f64, method: Method, options: &Options) -> Result<Run, Box<dyn Error>> {
    let most = options.most;
    let parameters = Parameters::of_cloth(&cloth, gravity_m_s2);
    let mut solver = Solver::new(cloth, parameters);
    let mesh = Arc::new(mesh_of(solver.cloth(), solver.masses_kg(), Knowledge::Uvs)?);
    let mut settings = Settings { response: method.response, ..Settings::default() };
    settings.path_rings = options.rings.unwrap_or(settings.path_rings);
    let mut untangler = Untangler::new(mesh, settings)?;
    untangler.set_labelled(method.off == Off::Labels);
    let mut run = Run::new();
    let (mut taken, mut late) = (Taken::default(), VecDeque::new());
    for step in 0..=most {
        let points = solver.cloth().points();
        run.after = count_edge_face(&points, &solver.cloth().triangles)?;
        run.count_steps(step);
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
        if options.verbose {
            let pairs = outcome.analysis.paths.pairs.iter().map(|pair| (pair.pair_type, pair.num_segments));
            println!("  {step:>4} {:>5} {:?}", run.after, pairs.collect::<Vec<_>>());
        }
        late.push_back(corrections.clone());
        if late.len() > options.lag
            && let Some(corrections) = late.pop_front()
        {
            method.take(&mut taken, &corrections, solver.masses_kg());
        }
        solver.step(DT_S, taken.help());
    }
    run.stretch = solver.cloth().worst_edge_ratio();
    Ok(run)
}
