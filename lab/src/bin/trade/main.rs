//! Speed against accuracy: scenes times settings, the Pareto front, and where the presets lie.
//!
//! ```sh
//! cargo run --release -p untangled-lab --bin trade -- [--out DIR] [--steps N] [--seeds N] [--edge METRES] [--repeats
//! N] [--markdown] [FILE...] cargo run --release -p untangled-lab --bin trade -- --out docs/results --markdown >
//! docs/results/trade.md
//! ```
//!
//! Tables go to standard output; `--out` writes `trade.csv`, with a row for each setting and scene, and `trade.svg`.
//! The host is the simulator of `clients/publisher`, the judge its exact check. Files (OBJ) take the place of its
//! scenes, without gravity and with their own shape at rest. All but the times is the same every time.
#![allow(
    clippy::print_stdout,
    clippy::cast_precision_loss,
    reason = "a program for developers, whose numbers are small"
)]

mod measure;
mod show;
#[cfg(test)]
mod tests;

use std::{env, error::Error, fs, path::Path};

use measure::{run::Scene, study::Plan};
use show::{
    document::{Document, Plans},
    report,
};
use untangled_lab::table::wrapped;
use untangled_publisher::{obj, scenes};

/// Gravity of the generated scenes.
const GRAVITY_M_S2: f64 = 9.81;

fn main() -> Result<(), Box<dyn Error>> {
    let (mut limit, mut seeds, mut edge_m, mut repeats, mut markdown) = (100, 2, 0.025, 1, false);
    let (mut out, mut files) = (None, Vec::new());
    let mut arguments = env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().ok_or_else(|| format!("{argument} needs a value"));
        match argument.as_str() {
            "--out" => out = Some(value()?),
            "--steps" => limit = value()?.parse()?,
            "--seeds" => seeds = value()?.parse()?,
            "--edge" => edge_m = value()?.parse()?,
            "--repeats" => repeats = value()?.parse()?,
            "--markdown" => markdown = true,
            option if option.starts_with("--") => return Err(format!("there is no option {option}").into()),
            _ => files.push(argument),
        }
    }
    let scenes = if files.is_empty() { generated(&scenes::Scene::SINGLE, seeds, edge_m)? } else { read(&files)? };
    if scenes.is_empty() || repeats == 0 {
        return Err("there is nothing to measure".into());
    }
    let plan = Plan { scenes, target_edges_m: vec![0.05, 0.025], limit, repeats };
    let gallery = Plan { scenes: generated(&["gallery"], seeds, edge_m)?, ..plan.clone() };
    let finer = Plan { scenes: generated(&scenes::Scene::SINGLE, 1, 0.5 * edge_m)?, repeats: 1, ..plan.clone() };
    let document = Document::measure(&Plans { main: plan, gallery, finer, resolution: 100 })?;
    print!("{}", if markdown { wrapped(&report::markdown(&document, edge_m, seeds)) } else { document.plain() });
    if let Some(out) = out {
        fs::create_dir_all(&out)?;
        fs::write(Path::new(&out).join("trade.csv"), document.csv())?;
        fs::write(Path::new(&out).join("trade.svg"), document.plot())?;
    }
    Ok(())
}

fn generated(names: &[&str], seeds: u64, edge_m: f64) -> Result<Vec<Scene>, Box<dyn Error>> {
    let mut all = Vec::new();
    for &name in names {
        let scene: scenes::Scene = name.parse()?;
        for seed in 1..=seeds {
            all.push(Scene { name: name.into(), cloth: scene.build(seed, edge_m), gravity_m_s2: GRAVITY_M_S2 });
        }
    }
    Ok(all)
}

/// Files that can't be simulated are named and left out.
fn read(files: &[String]) -> Result<Vec<Scene>, Box<dyn Error>> {
    let mut all = Vec::new();
    for file in files {
        match obj::read(Path::new(file)) {
            Ok(cloth) => {
                let name = Path::new(file).file_stem().unwrap_or_default().to_string_lossy().into_owned();
                all.push(Scene { name, cloth, gravity_m_s2: 0.0 });
            }
            Err(error) => eprintln!("{file}: {error}"),
        }
    }
    Ok(all)
}
