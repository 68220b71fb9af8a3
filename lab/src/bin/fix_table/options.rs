//! What the command line asks for.

use std::error::Error;

use untangled_lab::names::named;

use crate::row::Run;

/// The command line.
pub(crate) struct Options {
    pub(crate) run: Run,
    pub(crate) motions: u64,
    pub(crate) perturbations: u64,
    /// How often every triangle is split before.
    pub(crate) levels: u32,
    pub(crate) strip_uvs: bool,
    pub(crate) files: Vec<String>,
    pub(crate) crumples: Vec<u32>,
    pub(crate) frequency: f64,
    pub(crate) seed: u64,
    pub(crate) knots: Vec<u32>,
    pub(crate) overlap: f64,
    pub(crate) scissors: Vec<u32>,
    /// Whether each file is taken with a second one over it.
    pub(crate) over: bool,
}

impl Options {
    pub(crate) fn parse(mut arguments: impl Iterator<Item = String>) -> Result<Self, Box<dyn Error>> {
        let mut options = Self {
            run: Run::default(),
            motions: 0,
            perturbations: 0,
            levels: 0,
            strip_uvs: false,
            files: Vec::new(),
            crumples: Vec::new(),
            frequency: 1.6,
            seed: 1,
            knots: Vec::new(),
            overlap: 0.2,
            scissors: Vec::new(),
            over: false,
        };
        while let Some(argument) = arguments.next() {
            let mut value = || arguments.next().ok_or_else(|| format!("{argument} needs a value"));
            match argument.as_str() {
                "--quality" => options.run.settings.effort = named(&value()?)?,
                "--most" => options.run.settings.max_iterations = value()?.parse()?,
                "--seconds" => options.run.most_seconds = Some(value()?.parse()?),
                "--motions" => options.motions = value()?.parse()?,
                "--perturb" => options.perturbations = value()?.parse()?,
                "--subdivide" => options.levels = value()?.parse()?,
                "--no-uvs" => options.strip_uvs = true,
                "--crumple" => options.crumples.push(value()?.parse()?),
                "--frequency" => options.frequency = value()?.parse()?,
                "--seed" => options.seed = value()?.parse()?,
                "--knots" => options.knots.push(value()?.parse()?),
                "--overlap" => options.overlap = value()?.parse()?,
                "--scissors" => options.scissors.push(value()?.parse()?),
                "--over" => options.over = true,
                "--one-attempt" => options.run.settings.other_attempts = false,
                "--curve" => options.run.curve = true,
                "--watch" => options.run.watch = true,
                _ => options.files.push(argument),
            }
        }
        Ok(options)
    }
}
