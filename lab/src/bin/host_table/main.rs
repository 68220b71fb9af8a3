//! Tangles at edges of 1, 1/2, 1/4, ... of the coarsest, corrected in the example host by presets and responses: the
//! steps until each stays clean, what remains of it, and what it cost the cloth.
//!
//! ```sh
//! cargo run --release -p untangled-lab --bin host_table -- [--levels N,...] [--steps N] [--methods NAME,...]
//! [--steps-to-clean N] [--labels] [--same-mask] [--behind N] [--gravity M_S2] [--pinned] [--compact] [--verbose]
//! [SCENE|FILE...]
//! ```
//!
//! With `--compact` each input has one row at each level, with the steps of each method, or what was left.
//!
//! `--steps-to-clean` is the setting of that name (`inf`: forces by the edges alone). With `--same-mask` the mask round
//! the paths is as wide in metres at all levels; its width is a number of rings otherwise, and narrower on finer
//! meshes. With `--labels` the host leaves out single contacts instead of masking vertices.
//!
//! Methods are presets (`fast`, `balanced`, `accurate`), responses (`contour`, `displacement`, `coupled`, `mask`), and
//! those of the example host with a daemon of its own: `repair` (each tangled frame) and `auto` (forces, and a repair
//! where they make no progress). The host leaves out contacts of masked vertices there, and sends single precision.
//! Scenes are those of `clients/publisher`, all of them where none is named, under gravity. Files (OBJ) have their own
//! shape as rest shape and no gravity, and are made finer by splitting each triangle in four. `--gravity` and
//! `--pinned` (the uppermost fiftieth) are for files. With `--behind` corrections of presets and responses come so many
//! steps late, as to a host that does not wait for them.
#![allow(clippy::print_stdout, reason = "prints a table")]

mod inputs;
mod run;

use std::{env, error::Error};

use untangle::settings::{Quality, Settings};
use untangled_lab::{
    daemon::{daemon, serve},
    names::named,
};
use untangled_publisher::{repairs::RepairPolicy, scenes::Scene};
use untangled_testkit::process::{Daemon, Programs, TestDomain};

use crate::{
    inputs::{Input, Surroundings, input},
    run::{How, Run, run, run_repaired},
};

/// What the command line asks for.
struct Options {
    levels: Vec<u32>,
    how: How,
    methods: Vec<String>,
    steps_to_clean: Option<f64>,
    /// Whether the mask is as wide in metres at all levels.
    is_mask_kept: bool,
    is_compact: bool,
    surroundings: Surroundings,
    inputs: Vec<String>,
}

impl Options {
    fn parse(mut arguments: impl Iterator<Item = String>) -> Result<Self, Box<dyn Error>> {
        let methods = vec!["balanced".into()];
        let mut options = Self {
            levels: vec![0, 1, 2],
            how: How { most_steps: 100, labels: false, steps_behind: 0, verbose: false },
            methods,
            steps_to_clean: None,
            is_mask_kept: false,
            is_compact: false,
            surroundings: Surroundings::default(),
            inputs: Vec::new(),
        };
        while let Some(argument) = arguments.next() {
            let mut value = || arguments.next().ok_or_else(|| format!("{argument} needs a value"));
            match argument.as_str() {
                "--levels" => options.levels = value()?.split(',').map(str::parse).collect::<Result<_, _>>()?,
                "--steps" => options.how.most_steps = value()?.parse()?,
                "--methods" => options.methods = value()?.split(',').map(str::to_owned).collect(),
                "--steps-to-clean" => options.steps_to_clean = Some(value()?.parse()?),
                "--same-mask" => options.is_mask_kept = true,
                "--behind" => options.how.steps_behind = value()?.parse()?,
                "--gravity" => options.surroundings.gravity_m_s2 = value()?.parse()?,
                "--pinned" => options.surroundings.is_pinned = true,
                "--compact" => options.is_compact = true,
                "--labels" => options.how.labels = true,
                "--verbose" => options.how.verbose = true,
                _ => options.inputs.push(argument),
            }
        }
        if options.inputs.is_empty() {
            options.inputs = Scene::SINGLE.map(str::to_owned).to_vec();
        }
        Ok(options)
    }

    /// Runs a method on an input.
    fn run(&self, input: &Input, method: &str, level: u32, served: &mut Option<Served>) -> Result<Run, Box<dyn Error>> {
        let repair = match method {
            "repair" => RepairPolicy::Always,
            "auto" => RepairPolicy::Auto,
            _ => return run(input, &self.settings(method, level)?, &self.how),
        };
        let served = served.get_or_insert_with(Served::start);
        run_repaired(input, repair, &self.how, served.domain.name())
    }

    /// The settings of a preset or of a response by its name, at a level.
    fn settings(&self, method: &str, level: u32) -> Result<Settings, Box<dyn Error>> {
        let mut settings = Settings::default();
        settings.steps_to_clean = self.steps_to_clean.unwrap_or(settings.steps_to_clean);
        if self.is_mask_kept {
            // The corners of the faces along a path are a ring too.
            settings.path_rings = ((settings.path_rings + 1) << level) - 1;
        }
        match named::<Quality>(method) {
            Ok(quality) => quality.apply(&mut settings),
            Err(_) => settings.response = named(method)?,
        }
        Ok(settings)
    }
}

/// All runs of one method.
#[derive(Default)]
struct Summary {
    runs: usize,
    clean: usize,
    worse: usize,
    steps: usize,
    /// The largest distortion at the end, and the most that was left of momentum.
    distortion: f64,
    left: f64,
    /// Inputs, and those that came clean at all levels in steps that differ by a factor of at most 1.5 or by one.
    inputs: usize,
    even: usize,
}

impl Summary {
    fn add(&mut self, run: &Run, limit: usize) {
        self.runs += 1;
        self.clean += usize::from(run.steps.is_some());
        self.worse += usize::from(run.after > run.before);
        self.steps += run.steps.unwrap_or(limit);
        self.distortion = self.distortion.max(run.distortion);
        self.left = run.left.into_iter().fold(self.left, f64::max);
    }

    /// Adds the steps of one input at all levels.
    fn add_input(&mut self, steps: &[Option<usize>]) {
        self.inputs += 1;
        let Some(steps) = steps.iter().copied().collect::<Option<Vec<usize>>>() else { return };
        let (fewest, most) = (steps.iter().min().copied().unwrap_or(0), steps.iter().max().copied().unwrap_or(0));
        self.even += usize::from(2 * most <= 3 * fewest || most <= fewest + 1);
    }
}

/// A domain and its daemon, a process of this program.
struct Served {
    domain: TestDomain,
    _daemon: Daemon,
}

impl Served {
    fn start() -> Self {
        let domain = TestDomain::new();
        let client = |_: &str, _: &str| unreachable!("no client is a process of this program");
        let daemon = Programs { daemon, client }.start_daemon(&domain);
        Self { domain, _daemon: daemon }
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    if let [_, role, domain] = &env::args().collect::<Vec<_>>()[..]
        && role == "daemon"
    {
        serve(domain);
        return Ok(());
    }
    let options = Options::parse(env::args().skip(1))?;
    let mut served = None;
    print_head(&options);
    let mut summaries: Vec<Summary> = options.methods.iter().map(|_| Summary::default()).collect();
    for name in &options.inputs {
        let mut steps = vec![Vec::new(); options.methods.len()];
        for &level in &options.levels {
            let input = input(name, level, options.surroundings)?;
            let mut runs = Vec::new();
            for ((method, summary), steps) in options.methods.iter().zip(&mut summaries).zip(&mut steps) {
                let run = match options.run(&input, method, level, &mut served) {
                    Ok(run) => run,
                    Err(error) => {
                        println!("{}, {method}: {error}", input.name);
                        runs.push(None);
                        continue;
                    }
                };
                summary.add(&run, options.how.most_steps);
                steps.push(run.steps);
                if !options.is_compact {
                    print_row(&input, level, method, &run);
                }
                runs.push(Some(run));
            }
            if options.is_compact {
                print_runs(&input, level, &runs);
            }
        }
        summaries.iter_mut().zip(&steps).for_each(|(summary, steps)| summary.add_input(steps));
    }
    print_summaries(&options, &summaries);
    Ok(())
}

fn print_head(options: &Options) {
    let columns: Vec<&str> = match options.is_compact {
        true => ["input", "vertices", "before"].into_iter().chain(options.methods.iter().map(String::as_str)).collect(),
        false => {
            vec!["input", "vertices", "method", "before", "steps", "after", "most", "distortion", "left", "ms/step"]
        }
    };
    println!("| {} |\n|{}", columns.join(" | "), "---|".repeat(columns.len()));
}

/// The steps of each run of an input, or what was left.
fn print_runs(input: &Input, level: u32, runs: &[Option<Run>]) {
    let cell = |run: &Option<Run>| match run {
        Some(Run { steps: Some(steps), .. }) => steps.to_string(),
        Some(Run { before, after, .. }) if after > before => format!("**{after} left**"),
        Some(Run { after, .. }) => format!("{after} left"),
        None => "failed".to_owned(),
    };
    let cells: Vec<String> = runs.iter().map(cell).collect();
    let before = runs.iter().flatten().next().map_or(0, |run| run.before);
    let (name, vertices) = (&input.name, input.cloth.positions.len());
    println!("| {name} /{} | {vertices} | {before} | {} |", 1 << level, cells.join(" | "));
}

fn print_row(input: &Input, level: u32, method: &str, run: &Run) {
    let Run { before, after, most, steps, distortion, left: [force, torque], time, busy_steps } = *run;
    let steps = steps.map_or("-".into(), |steps| steps.to_string());
    let ms = 1e3 * time.as_secs_f64() / f64::from(busy_steps.max(1));
    let after = if after > before { format!("**{after}**") } else { after.to_string() };
    let left = force.max(torque);
    let name = format!("{} /{}", input.name, 1 << level);
    let vertices = input.cloth.positions.len();
    println!(
        "| {name} | {vertices} | {method} | {before} | {steps} | {after} | {most} | {distortion:.2} | {left:.0e} \
         | {ms:.2} |"
    );
}

fn print_summaries(options: &Options, summaries: &[Summary]) {
    let columns = ["method", "clean", "even", "steps, mean", "ended worse", "distortion, worst", "left, worst"];
    println!("\n| {} |\n|{}", columns.join(" | "), "---|".repeat(columns.len()));
    for (method, summary) in options.methods.iter().zip(summaries) {
        let Summary { runs, clean, worse, steps, distortion, left, inputs, even } = *summary;
        #[expect(clippy::cast_precision_loss, reason = "counts of runs")]
        let mean = steps as f64 / runs.max(1) as f64;
        println!(
            "| {method} | {clean} of {runs} | {even} of {inputs} | {mean:.1} | {worse} | {distortion:.2} | {left:.0e} |"
        );
    }
}
