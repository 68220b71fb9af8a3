//! The command line of the example host.

use std::{
    fs,
    io::{self, Write},
    path::{Path, PathBuf},
    process::ExitCode,
    time::Duration,
};

use clap::{Args, Parser, ValueEnum};
use untangled_client::CorrectionKind;

use crate::{
    host::{Host, HostError, HostOptions, Use},
    mesh::{Cloth, Vec3},
    obj,
    repairs::RepairPolicy,
    report::Summary,
    run::{RunOptions, run},
    scenes::Scene,
    solver::{Parameters, Solver},
    values::{finite, json_object, not_negative, positive},
};

/// Simulates a cloth, publishes each step to an untangled daemon and applies its corrections.
///
/// Exit code 0: the exact check finds the last state free of intersections; 1: intersections remain; 2: an error.
#[derive(Debug, Parser)]
#[command(name = "untangled-publisher", version)]
pub struct Cli {
    /// What to do.
    #[command(flatten)]
    pub args: PublishArgs,
}

/// What to simulate, how, and how to talk to the daemon.
#[derive(Clone, Debug, Args)]
pub struct PublishArgs {
    /// Wavefront OBJ file to simulate, without gravity; its shape is the rest shape.
    pub file: Option<PathBuf>,
    /// Scene to generate where no file is given: bag, tongue, curtains, crease, twist, drop, wedge or gallery.
    #[arg(long, default_value = "gallery", conflicts_with = "file")]
    pub scene: Scene,
    /// Length of the edges of a generated scene.
    #[arg(long, value_name = "METRES", default_value_t = 0.028, value_parser = positive)]
    pub edge_m: f64,
    /// Seed of a generated scene.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Domain of the daemon.
    #[arg(long, value_name = "NAME")]
    pub domain: Option<String>,
    /// What corrections the daemon shall send [default: force for scenes, displacement for files, which need no
    /// motion].
    #[arg(long, value_enum)]
    pub correction: Option<Kind>,
    /// Which frames the daemon repairs, which is one displacement to where nothing intersects: never, always, or auto
    /// for those at which a tangle does not shrink.
    #[arg(long, value_name = "WHEN", default_value = "auto")]
    pub repair: RepairPolicy,
    /// How long to wait for a repair before the simulation goes on without.
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0, value_parser = positive)]
    pub repair_deadline_s: f64,
    /// Ignore all corrections.
    #[arg(long, group = "control")]
    pub no_corrections: bool,
    /// Switch self-contact off where the daemon says so, but apply no forces.
    #[arg(long, group = "control")]
    pub mask_only: bool,
    /// Apply forces, but leave self-contact on everywhere.
    #[arg(long, group = "control")]
    pub force_only: bool,
    /// Most steps to simulate.
    #[arg(long, value_name = "N", default_value_t = 600)]
    pub frames: usize,
    /// Most steps a second; without it there is no limit.
    #[arg(long, value_name = "HZ", value_parser = positive)]
    pub rate: Option<f64>,
    /// Stop once so many states in a row are clean; 0 never stops early.
    #[arg(long, value_name = "N", default_value_t = 10)]
    pub clean_frames: usize,
    /// Print a line every so many frames; 0 for none.
    #[arg(long, value_name = "N", default_value_t = 10)]
    pub report_every: usize,
    /// Print a table of few lines, as `untangled demo` shows it.
    #[arg(long, hide = true)]
    pub brief: bool,
    /// Write before.obj and after.obj into this folder.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Write how the run ended as JSON.
    #[arg(long, value_name = "FILE")]
    pub summary: Option<PathBuf>,
    /// Settings of the untangler as a JSON object, by the names that `untangled config` explains.
    #[arg(long, value_name = "JSON", value_parser = json_object)]
    pub settings: Option<serde_json::Value>,
    /// How long to wait for a correction before a step is made without.
    #[arg(long, value_name = "MILLISECONDS", default_value_t = 1000)]
    pub deadline_ms: u64,
    /// How long to wait for the daemon at the start.
    #[arg(long, value_name = "MILLISECONDS", default_value_t = 10_000)]
    pub connect_timeout_ms: u64,
    /// The cloth and its simulation.
    #[command(flatten)]
    pub cloth: ClothArgs,
}

impl PublishArgs {
    /// The kind of correction to ask for. A file is a shape to clean, not a motion; displacements add no velocity to
    /// it.
    fn correction_kind(&self) -> CorrectionKind {
        let usual = if self.file.is_some() { Kind::Displacement } else { Kind::Force };
        self.correction.unwrap_or(usual).into()
    }
}

/// Properties of the simulated cloth.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Simulation")]
pub struct ClothArgs {
    /// Length of a step.
    #[arg(long, value_name = "SECONDS", default_value_t = 1.0 / 60.0, value_parser = positive)]
    pub dt_s: f64,
    /// Substeps of a step.
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..))]
    pub substeps: u32,
    /// Gravity along -z in m/s^2 [default: 9.81 for scenes, 0 for files].
    #[arg(long, value_name = "M_S2", value_parser = finite, allow_negative_numbers = true)]
    pub gravity: Option<f64>,
    /// Mass of the cloth per area in kg/m^2.
    #[arg(long, value_name = "KG_M2", default_value_t = 0.2, value_parser = positive)]
    pub density: f64,
    /// Stiffness of each edge in N/m.
    #[arg(long, value_name = "N_M", default_value_t = 1e3, value_parser = positive)]
    pub stretch: f64,
    /// Bending stiffness in N m.
    #[arg(long, value_name = "N_M", default_value_t = 1e-4, value_parser = positive)]
    pub bending: f64,
    /// Rate at which air slows the cloth down, in 1/s.
    #[arg(long, value_name = "1_S", default_value_t = 8.0, value_parser = not_negative)]
    pub drag: f64,
    /// Distance that self-contact keeps [default: a fifth of the mean edge length].
    #[arg(long, value_name = "METRES", value_parser = not_negative)]
    pub thickness_m: Option<f64>,
}

/// Kinds of corrections.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Kind {
    /// Newtons, over one step.
    Force,
    /// m/s^2, over one step.
    Acceleration,
    /// m/s.
    Velocity,
    /// Metres.
    Displacement,
}

impl From<Kind> for CorrectionKind {
    fn from(kind: Kind) -> Self {
        match kind {
            Kind::Force => Self::Force,
            Kind::Acceleration => Self::Acceleration,
            Kind::Velocity => Self::VelocityChange,
            Kind::Displacement => Self::Displacement,
        }
    }
}

/// Runs the command and prints what happens: the body of `main`.
#[must_use]
pub fn main(args: &PublishArgs) -> ExitCode {
    match publish(args, &mut io::stdout().lock()) {
        Ok(summary) if summary.clean => ExitCode::SUCCESS,
        Ok(_) => ExitCode::from(1),
        Err(error) => {
            // A closed standard error can't be reported anywhere.
            let _ = writeln!(io::stderr(), "error: {error}");
            ExitCode::from(2)
        }
    }
}

/// Simulates as the arguments say; lines go to `out`.
///
/// # Errors
/// [`HostError`].
pub fn publish(args: &PublishArgs, out: &mut dyn Write) -> Result<Summary, HostError> {
    let cloth = match &args.file {
        Some(file) => obj::read(file)?,
        None => args.scene.build(args.seed, args.edge_m),
    };
    let parameters = parameters(args, &cloth);
    let solver = Solver::new(cloth, parameters);
    write_obj(args.out.as_deref(), "before.obj", solver.cloth())?;
    let mut host = Host::new(solver, host_options(args))?;
    let options = RunOptions {
        max_frames: args.frames,
        num_clean_frames: args.clean_frames,
        report_every: args.report_every,
        least_step: args
            .rate
            .map_or(Duration::ZERO, |hz| Duration::try_from_secs_f64(1.0 / hz).unwrap_or(Duration::MAX)),
        brief: args.brief,
        kind: args.correction_kind(),
    };
    if !args.brief {
        let cloth = host.solver().cloth();
        writeln!(out, "{} vertices, {} triangles", cloth.positions.len(), cloth.triangles.len())?;
    }
    let summary = run(&mut host, options, out)?;
    write_obj(args.out.as_deref(), "after.obj", host.solver().cloth())?;
    if let Some(path) = &args.summary {
        let json = serde_json::to_string_pretty(&summary).map_err(io::Error::from)?;
        fs::write(path, json + "\n").map_err(|source| HostError::File { path: path.clone(), source })?;
    }
    Ok(summary)
}

fn parameters(args: &PublishArgs, cloth: &Cloth) -> Parameters {
    let ClothArgs { substeps, gravity, density, stretch, bending, drag, thickness_m, .. } = args.cloth;
    let gravity = gravity.unwrap_or(if args.file.is_some() { 0.0 } else { 9.81 });
    Parameters {
        gravity_m_s2: Vec3::new(0.0, 0.0, -gravity),
        density_kg_m2: density,
        stretch_n_m: stretch,
        bending_n_m: bending,
        drag_1_s: drag,
        thickness_m: thickness_m.unwrap_or_else(|| 0.2 * cloth.mean_edge_length_m()),
        friction: 0.0,
        num_substeps: substeps,
        single_precision: true,
    }
}

fn host_options(args: &PublishArgs) -> HostOptions {
    let use_of_corrections = match (args.no_corrections, args.mask_only, args.force_only) {
        (true, _, _) => Use::Nothing,
        (_, true, _) => Use::MaskOnly,
        (_, _, true) => Use::ValuesOnly,
        _ => Use::Everything,
    };
    // Controls show what corrections do, and take none away by other means.
    let repair = if use_of_corrections == Use::Everything { args.repair } else { RepairPolicy::Never };
    HostOptions {
        repair,
        repair_deadline: Duration::try_from_secs_f64(args.repair_deadline_s).unwrap_or(Duration::MAX),
        domain: args.domain.clone(),
        connect_timeout: Duration::from_millis(args.connect_timeout_ms),
        deadline: Duration::from_millis(args.deadline_ms),
        dt_s: args.cloth.dt_s,
        correction: args.correction_kind(),
        use_of_corrections,
        settings: args.settings.clone().unwrap_or_default(),
    }
}

fn write_obj(folder: Option<&Path>, name: &str, cloth: &Cloth) -> Result<(), HostError> {
    if let Some(folder) = folder {
        fs::create_dir_all(folder).map_err(|source| HostError::File { path: folder.into(), source })?;
        obj::write(&folder.join(name), cloth)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_without_arguments_are_those_of_cloth() {
        let args = Cli::parse_from(["untangled-publisher"]).args;
        let cloth = Scene::Tongue.build(1, 0.05);
        assert_eq!(parameters(&args, &cloth), Parameters::of_cloth(&cloth, 9.81));
        let moon = Cli::parse_from(["untangled-publisher", "--gravity", "-1.62"]).args;
        assert_eq!(parameters(&moon, &cloth).gravity_m_s2, Vec3::new(0.0, 0.0, 1.62));
    }

    #[test]
    fn settings_reach_the_host_as_an_object() {
        let args = Cli::parse_from(["untangled-publisher", "--settings", r#"{"quality": "accurate"}"#]).args;
        assert_eq!(host_options(&args).repair, RepairPolicy::Auto);
        assert_eq!(host_options(&args).settings, serde_json::json!({"quality": "accurate"}));
    }
}
