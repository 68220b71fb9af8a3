//! `untangled fix`: untangles mesh files and writes them back.
//!
//! | module | purpose |
//! |---|---|
//! | `pins` | the pin file |
//! | `target` | where files are written, and how they come there whole |
//! | `repair` | relax, write, read back, check |
//! | `distortion`, `report` | what is said about it |
//! | `progress`, `interrupt` | the terminal and Ctrl-C |

mod distortion;
mod interrupt;
mod pins;
mod progress;
mod repair;
mod report;
mod target;
#[cfg(test)]
mod tests;

use std::{
    fs,
    io::{self, Write},
    path::{Path, PathBuf},
    time::Instant,
};

use clap::ValueEnum;
use thiserror::Error;

pub use distortion::Distortion;
pub use report::{Blocked, Counts, Report};

use untangle::{analysis::analyse, relax::{Quality, RelaxError, RelaxSettings, relax}};
use crate::cli::{
        Outcome,
        input::{self, Input, InputError},
    };
use untangled_mesh_io::{MeshFile, Output, WriteError};
use interrupt::Interrupt;
use progress::Progress;
use repair::{Job, Repair, Repaired, Solver};
use target::Target;

/// Untangle mesh files: move vertices until nothing intersects, and write everything else back as it was.
///
/// Vertex k of the output is vertex k of the input; polygons, materials, groups, normals and comments stay. A clean input is written
/// unchanged. What is written is read back and checked exactly before it takes its place; inputs are never overwritten. Ctrl-C ends the
/// work and writes nothing.
///
/// The extension of OUT decides its format. OBJ from OBJ, PLY from PLY and glTF or GLB from glTF or GLB keep all that is not geometry, and so
/// do several OBJ in one OBJ; any other combination keeps vertices, polygons and texture coordinates. glTF is only written from
/// one glTF; a buffer of it that changed, or that would not be found from the folder of OUT, is embedded. Other files that an input names
/// (materials, images) are named as before, and looked for beside OUT.
///
/// Exit code: 0 clean; 1 intersections remain, and OUT is the best state found; 2 bad input or usage, another error, or Ctrl-C.
#[derive(Clone, Debug, clap::Args)]
pub struct FixArgs {
    /// Mesh files (OBJ, PLY, glTF, GLB); several are pieces in one world
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// File to write (.obj, .ply, .gltf, .glb), with the pieces in order; or a folder, for one file per input under its own name
    #[arg(short, long, value_name = "OUT")]
    pub out: PathBuf,
    /// Print one JSON document (schema untangled.fix/1) instead of lines for people
    #[arg(long)]
    pub json: bool,
    /// Write the JSON document to a file
    #[arg(long, value_name = "FILE")]
    pub report: Option<PathBuf>,
    /// Give up after this many iterations
    #[arg(long, value_name = "N", default_value_t = RelaxSettings::default().max_iterations)]
    pub max_iterations: usize,
    /// Time against result
    #[arg(long, value_enum, default_value_t)]
    pub quality: QualityArg,
    /// Keep vertices where they are: a file of 0-based indices separated by white space, with # comments; of several inputs together, pieces
    /// in order
    #[arg(long, value_name = "FILE")]
    pub pin: Option<PathBuf>,
    /// Replace OUT (and the report) if it exists; never an input
    #[arg(long)]
    pub overwrite: bool,
}

/// [`Quality`] as an argument.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum QualityArg {
    /// Fewest candidates a step
    Fast,
    /// In between
    #[default]
    Balanced,
    /// Most candidates a step, smallest steps
    Accurate,
}

impl From<QualityArg> for Quality {
    fn from(quality: QualityArg) -> Self {
        match quality {
            QualityArg::Fast => Self::Fast,
            QualityArg::Balanced => Self::Balanced,
            QualityArg::Accurate => Self::Accurate,
        }
    }
}

/// Why nothing was written.
#[derive(Debug, Error)]
pub enum FixError {
    /// The files are no world that can be untangled.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The pin file can't be used.
    #[error("{}{}: {reason}", path.display(), line.map_or(String::new(), |line| format!(":{line}")))]
    Pins {
        /// The pin file.
        path: PathBuf,
        /// Line at fault, from 1.
        line: Option<usize>,
        /// What is wrong.
        reason: String,
    },
    /// A file can't be written.
    #[error("{}: {reason}", path.display())]
    Target {
        /// The file.
        path: PathBuf,
        /// Why not.
        reason: String,
    },
    /// Two outputs would be one file.
    #[error("{}: would be written twice, from {} and from {}", path.display(), inputs[0].display(), inputs[1].display())]
    Twice {
        /// The output.
        path: PathBuf,
        /// What would be written there.
        inputs: [PathBuf; 2],
    },
    /// Vertices have to move that can't.
    #[error("{}: vertices {first} to {last} can't be moved: {reason}; write .obj or .ply, or pin these vertices", path.display())]
    Fixed {
        /// The output.
        path: PathBuf,
        /// First vertex, counted over all inputs from 0.
        first: usize,
        /// Last vertex.
        last: usize,
        /// Why.
        reason: String,
    },
    /// What was written is not what it should be.
    #[error("what was written can't be read back: {0}")]
    ReadBack(InputError),
    /// The relaxation refused a state.
    #[error("the relaxation failed: {0}")]
    Relax(RelaxError),
    /// Ctrl-C or SIGTERM.
    #[error("interrupted; nothing was written")]
    Interrupted,
    /// Signals can't be heard.
    #[error("listening for Ctrl-C: {0}")]
    Signals(io::Error),
    /// The report can't be printed.
    #[error("standard output: {0}")]
    Print(io::Error),
}

/// Runs the subcommand: prints the report on standard output.
///
/// # Errors
/// [`FixError`]; one line, exit code 2.
pub fn run(args: &FixArgs) -> Result<Outcome, FixError> {
    let mut interrupt = Interrupt::listen().map_err(FixError::Signals)?;
    let report = fix(args, &mut relax, &mut interrupt)?;
    let text = if args.json { report.to_json() } else { report.to_string() };
    match io::stdout().lock().write_all(text.as_bytes()) {
        // Who stops reading has read enough.
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(FixError::Print(error)),
        _ if report.clean => Ok(Outcome::Clean),
        _ => Ok(Outcome::Remaining),
    }
}

/// Untangles and writes files.
fn fix(args: &FixArgs, solver: Solver<'_>, interrupt: &mut Interrupt) -> Result<Report, FixError> {
    let start = Instant::now();
    let mut progress = Progress::new();
    progress.say("reading");
    let files = input::read_files(&args.files)?;
    let (jobs, report_target) = plan(args, &files)?;
    let mut world = input::join(&args.files, &files)?;
    let pins = args.pin.as_deref().map(|path| pins::read(path, world.positions.len())).transpose()?.unwrap_or_default();
    world.description.pins.clone_from(&pins);
    let input = Input::new(&files, world)?;
    interrupt.check()?;
    progress.say("analysing");
    let before = Counts::new(&analyse(&input.mesh, &input.frame));
    interrupt.check()?;
    let settings = RelaxSettings {
        quality: args.quality.into(),
        max_iterations: args.max_iterations,
        // Rounding all states would change digits of a file that can hold them.
        single_precision: jobs.iter().all(|job| job.output.is_single_precision()),
    };
    let repair = Repair { jobs: &jobs, pins: &pins, settings };
    let repaired = if before.is_clean() {
        interrupt.wait_for_files();
        Repaired { written: repair.write(&input.positions)?, history: Vec::new(), blocked: Vec::new() }
    } else {
        check_movable(&jobs, &input)?;
        progress.say("untangling");
        repair.run(&input, &before, solver, interrupt, &mut progress)?
    };
    let Repaired { written, history, blocked } = repaired;
    let report = Report {
        schema: "untangled.fix/1",
        files: args.files.iter().map(|path| path.display().to_string()).collect(),
        outputs: jobs.iter().map(|job| job.target.path.display().to_string()).collect(),
        clean: written.counts.is_clean(),
        num_iterations: history.len(),
        seconds: start.elapsed().as_secs_f64(),
        before,
        distortion: Distortion::new(&input.mesh, &input.positions, &written.input.positions),
        after: written.counts,
        blocked,
        history,
    };
    let report_file = report_target.map(|target| {
        target.stage(|out| out.write_all(report.to_json().as_bytes()).map_err(|source| target.failed(&source)))
    });
    let report_file = report_file.transpose()?;
    interrupt.check()?;
    // From here on files take their places.
    for staged in written.staged.into_iter().chain(report_file) {
        staged.persist()?;
    }
    Ok(report)
}

/// What is written where, and where the report goes. Refuses what must not be overwritten and what can't be written.
fn plan<'a>(args: &FixArgs, files: &'a [MeshFile]) -> Result<(Vec<Job<'a>>, Option<Target>), FixError> {
    let inputs: Vec<&Path> = files.iter().flat_map(MeshFile::source_files).chain(args.pin.as_deref()).collect();
    let target = |path: PathBuf| Target::new(path, &inputs, args.overwrite);
    let groups: Vec<(PathBuf, &[MeshFile])> = if fs::metadata(&args.out).is_ok_and(|metadata| metadata.is_dir()) {
        let name = |file: &MeshFile| args.out.join(file.path().file_name().unwrap_or_default());
        files.iter().map(|file| (name(file), std::slice::from_ref(file))).collect()
    } else {
        vec![(args.out.clone(), files)]
    };
    let mut jobs: Vec<Job<'a>> = Vec::new();
    let mut first = 0;
    for (path, group) in groups {
        let target = target(path)?;
        if let Some(other) = jobs.iter().find(|job| job.target.is_same_place(&target)) {
            let inputs = [other.output.files(), group].map(|files| files[0].path().to_path_buf());
            return Err(FixError::Twice { path: target.path, inputs });
        }
        let refused = |source: WriteError| FixError::Target { path: target.path.clone(), reason: source.to_string() };
        let output = Output::new(group, &target.path).map_err(refused)?;
        let vertices = first..first + group.iter().map(|file| file.positions().len()).sum::<usize>();
        first = vertices.end;
        jobs.push(Job { output, target, vertices });
    }
    let report = args.report.clone().map(target).transpose()?;
    if let Some(report) = &report
        && jobs.iter().any(|job| job.target.is_same_place(report))
    {
        let reason = "is an output, and can't be the report as well".to_owned();
        return Err(FixError::Target { path: report.path.clone(), reason });
    }
    Ok((jobs, report))
}

/// Refuses, before any work is done, what could not be written after it.
fn check_movable(jobs: &[Job<'_>], input: &Input) -> Result<(), FixError> {
    for Job { output, target, vertices } in jobs {
        for (range, reason) in output.fixed_vertices() {
            let range = range.start + vertices.start..range.end + vertices.start;
            if !range.clone().all(|vertex| input.is_pinned(vertex)) {
                let (path, reason) = (target.path.clone(), reason.to_owned());
                return Err(FixError::Fixed { path, first: range.start, last: range.end - 1, reason });
            }
        }
        output.write(&input.positions[vertices.clone()], &mut io::sink()).map_err(|source| target.failed(&source))?;
    }
    Ok(())
}
