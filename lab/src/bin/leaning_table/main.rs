//! Tangles that other cloth leans on, under gravity and friction, in the example host's solver: what becomes of the
//! tangle, and of what leans.
//!
//! ```sh
//! cargo run --release -p untangled-lab --bin leaning_table -- --markdown > docs/results/leaning.md
//! cargo run --release -p untangled-lab --bin leaning_table -- [--steps N] [--edge METRES] [--only HELP] [--scene NAME]
//! [--verbose]
//! ```
#![allow(clippy::print_stdout, reason = "prints a table")]

mod run;
mod scenes;

use std::{env, error::Error};

use untangle::settings::Response;
use untangled_lab::table::{print_header, print_text};

use run::{Help, Off, Run, run};
use scenes::SCENES;

const HELPS: [Help; 9] = [
    Help { name: "no help", response: Response::Mask, off: Off::Nothing },
    Help { name: "force + mask, 2 rings", response: Response::Rbf, off: Off::Mask(2) },
    Help { name: "force + mask, 1 ring", response: Response::Rbf, off: Off::Mask(1) },
    Help { name: "force + mask, 0 rings", response: Response::Rbf, off: Off::Mask(0) },
    Help { name: "labels only", response: Response::Mask, off: Off::Labels },
    Help { name: "force + labels", response: Response::Rbf, off: Off::Labels },
    Help { name: "contour + labels", response: Response::Contour, off: Off::Labels },
    Help { name: "displacement + labels", response: Response::Displacement, off: Off::Labels },
    Help { name: "coupled + labels", response: Response::Coupled, off: Off::Labels },
];

struct Options {
    num_steps: usize,
    edge_m: f64,
    only: String,
    scene: String,
    markdown: bool,
    verbose: bool,
}

impl Options {
    fn parse(mut arguments: impl Iterator<Item = String>) -> Result<Self, Box<dyn Error>> {
        let (only, scene) = (String::new(), String::new());
        let mut options = Self { num_steps: 150, edge_m: 0.02, only, scene, markdown: false, verbose: false };
        while let Some(argument) = arguments.next() {
            let mut value = || arguments.next().ok_or_else(|| format!("{argument} needs a value"));
            match argument.as_str() {
                "--steps" => options.num_steps = value()?.parse()?,
                "--edge" => options.edge_m = value()?.parse()?,
                "--only" => options.only = value()?,
                "--scene" => options.scene = value()?,
                "--markdown" => options.markdown = true,
                "--verbose" => options.verbose = true,
                _ => return Err(format!("`{argument}` is no option").into()),
            }
        }
        Ok(options)
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let options = Options::parse(env::args().skip(1))?;
    if options.markdown {
        print_text(&format!(
            "# Tangles that other cloth leans on\n\nMade by `cargo run --release -p untangled-lab --bin leaning_table \
             -- --markdown > docs/results/leaning.md`; do not edit.\n\nScenes under gravity with friction 0.3 in the \
             solver of `clients/publisher`, edges of {} m, {} steps of 1/60 s. Counts are edge-face hits by the exact \
             check, which shares no code with the untangler: at the start, most of a step, and at the end. *Elsewhere* \
             is the most of a step between pieces that did not intersect at the start: cloth that leant and fell \
             through. *Steps* is when the last step that was not clean ended. *Stretch* is the edge ratio to rest that \
             is farthest from 1 at the end.\n",
            options.edge_m, options.num_steps
        ));
    }
    print_header(&["scene", "help", "start", "steps", "most", "end", "elsewhere", "stretch"]);
    for (name, build) in SCENES.into_iter().filter(|(name, _)| name.contains(&options.scene)) {
        for help in HELPS.into_iter().filter(|help| help.name.contains(&options.only)) {
            let run = run(build(options.edge_m), options.edge_m, help, options.num_steps, options.verbose)?;
            print_row(name, help.name, &run);
        }
    }
    Ok(())
}

fn print_row(scene: &str, help: &str, run: &Run) {
    let Run { before, steps, after, most_elsewhere, most, stretch } = run;
    let steps = steps.map_or("-".to_owned(), |steps| steps.to_string());
    println!("| {scene} | {help} | {before} | {steps} | {most} | {after} | {most_elsewhere} | {stretch:.2} |");
}
