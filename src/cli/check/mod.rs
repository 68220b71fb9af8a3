//! `untangled check`: analyses mesh files and says what intersects.

mod meetings;
mod report;
#[cfg(test)]
mod tests;

use std::{
    fs::File,
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
    time::Instant,
};

use thiserror::Error;

pub use report::Report;

use untangle::{
    analysis::Analysis,
    stage::{Stage, StageObserver},
};
use untangled_mesh_io::{FileFormat, write_contours_obj, write_contours_ply};

use super::{
    certificate::Certificate,
    gap::{Asked, GapArgs, GapError, GapReport},
    input::{self, Input, InputError, MAX_FACE_PAIRS, analyse_within, is_same_file},
    outcome::{self, Outcome},
    owners::Owners,
    roles::{BodyCounts, LayerReport, RoleArgs, Roles},
    sequence::args::CacheArgs,
    weld::WeldArg,
};
use meetings::Meeting;
use report::StageTimes;

/// Finds all intersections of one mesh, or of several in one world.
///
/// Exit code: 0 without intersections, 1 with, or where vertices are inside of a body or behind an inner layer, or
/// primitives nearer than a gap that was asked for; 2 for bad input.
///
/// With --cache all frames of a sequence are checked, on all processors. --json then prints a line for each frame as
/// it is done, and the totals last (schema untangled.sequence/1); the lines are the same for any number of threads.
#[derive(Clone, Debug, clap::Args)]
pub struct CheckArgs {
    /// Mesh files (OBJ, PLY, STL, glTF, GLB); several are pieces in one world
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// Print one JSON document (schema untangled.check/1) instead of a table
    #[arg(long)]
    pub json: bool,
    /// List the intersecting pairs of triangles
    #[arg(long)]
    pub face_pairs: bool,
    /// Write the intersection paths as lines: .obj (groups by type) or .ply (colours by type)
    #[arg(long, value_name = "FILE")]
    pub contours: Option<PathBuf>,
    /// Replace the file of `--contours` if it exists; never an input
    #[arg(long)]
    pub overwrite: bool,
    /// Say how long each stage took
    #[arg(short, long)]
    pub verbose: bool,
    /// Vertices in one place that are one along seams: those in `exact`ly one place, those within so many METRES, or
    /// none (`off`)
    #[arg(long, value_name = "exact|off|METRES", default_value = "exact")]
    pub weld: WeldArg,
    /// `--gap` and `--gap-for`.
    #[command(flatten)]
    pub gap: GapArgs,
    /// What files are beside cloth
    #[command(flatten)]
    pub roles: RoleArgs,
    /// End with an error where more pairs of triangles intersect: a million takes up to two gigabytes
    #[arg(long, value_name = "N", default_value_t = MAX_FACE_PAIRS, value_parser = clap::value_parser!(u64).range(1..))]
    pub max_face_pairs: u64,
    /// `--cache`, `--body-cache` and `--frames`.
    #[command(flatten)]
    pub sequence: CacheArgs,
}

/// Why a check could not be done.
#[derive(Debug, Error)]
pub enum CheckError {
    /// The files can't be analysed.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The gap can't be checked.
    #[error(transparent)]
    Gap(#[from] GapError),
    /// `--contours` names neither OBJ nor PLY.
    #[error("{}: contours are written as .obj or .ply", .0.display())]
    ContoursFormat(PathBuf),
    /// `--contours` names an input.
    #[error("{}: is an input and would be overwritten by the contours", .0.display())]
    ContoursOverInput(PathBuf),
    /// `--contours` names a file that exists.
    #[error("{}: exists; --overwrite replaces it", .0.display())]
    ContoursExist(PathBuf),
    /// `--contours` names a file that may not be written.
    #[error("{}: is write-protected, and --overwrite does not replace such files", .0.display())]
    ContoursProtected(PathBuf),
    /// An output can't be written.
    #[error("{}: can't be written: {source}", path.display())]
    Write {
        /// The file, or `standard output`.
        path: PathBuf,
        /// What is wrong.
        source: io::Error,
    },
}

/// Runs the subcommand: prints the report on standard output.
///
/// # Errors
/// [`CheckError`]; one line, exit code 2.
pub fn run(args: &CheckArgs) -> Result<Outcome, CheckError> {
    let inputs = [args.files.as_slice(), &args.roles.bodies].concat();
    let contours = args.contours.as_deref().map(|path| contours_format(path, &inputs, args.overwrite)).transpose()?;
    let (mut report, analysis) =
        check_within(&args.files, &args.roles, args.weld, args.face_pairs, args.max_face_pairs, args.gap.asked())?;
    if let (Some(path), Some(format)) = (&args.contours, contours) {
        write_contours(path, format, &analysis).map_err(|source| CheckError::Write { path: path.clone(), source })?;
    }
    report.verbose = args.verbose;
    let text = if args.json { report.to_json() } else { outcome::printable(&report.to_string()) };
    outcome::print(&text).map_err(|source| CheckError::Write { path: "standard output".into(), source })?;
    let is_too_close = report.gap.as_ref().is_some_and(|gap| gap.num_pairs_below > 0);
    Ok(if report.is_clean() && !is_too_close { Outcome::Clean } else { Outcome::Remaining })
}

/// Reads and analyses files as one world, with the usual limit on what may intersect.
///
/// # Errors
/// [`CheckError`], naming the file and the element at fault.
pub fn check(files: &[PathBuf], weld: WeldArg, list_face_pairs: bool) -> Result<(Report, Analysis), CheckError> {
    check_within(files, &RoleArgs::default(), weld, list_face_pairs, MAX_FACE_PAIRS, None)
}

fn check_within(
    files: &[PathBuf],
    roles: &RoleArgs,
    weld: WeldArg,
    list_face_pairs: bool,
    max_face_pairs: u64,
    gap: Option<Asked>,
) -> Result<(Report, Analysis), CheckError> {
    let mut clock = StageClock::default();
    clock.start(StageTimes::READ);
    let meshes = input::read_files(files)?;
    let roles = Roles::read(roles, &meshes, weld)?;
    clock.start(StageTimes::MESH);
    let input = Input::new(&meshes, roles.join(files, &meshes)?, weld)?;
    let analysis = analyse_within(files, &input, max_face_pairs, &mut clock)?;
    clock.start(StageTimes::CERTIFY);
    let certificate = Certificate::of(&meshes, &roles, &input);
    let owners = Owners::new(meshes.iter().chain(&roles.bodies));
    if gap.is_some() {
        clock.start(StageTimes::GAP);
    }
    let gap = gap.map(|asked| GapReport::of(&asked, &input, &owners)).transpose()?;
    StageObserver::end(&mut clock);
    // What is said of the mesh is said of the cloth.
    let cloth = if roles.has_no_body() { None } else { Some(Input::new(&meshes, input::join(files, &meshes)?, weld)?) };
    let shape = cloth.as_ref().unwrap_or(&input);
    let mut report = Report::new(files, shape, &input.weld, &analysis, certificate, clock.times, list_face_pairs);
    report.bodies = roles.reports();
    report.layers = LayerReport::of(&roles, &input);
    report.body_counts = BodyCounts::of(&input, &analysis.intersections);
    report.meetings = Meeting::of(&analysis, &owners);
    report.gap = gap;
    Ok((report, analysis))
}

/// The format of the contours, if they may be written there.
fn contours_format(path: &Path, inputs: &[PathBuf], overwrite: bool) -> Result<FileFormat, CheckError> {
    let format = FileFormat::of_name(path)
        .filter(|format| matches!(format, FileFormat::Obj | FileFormat::Ply))
        .ok_or_else(|| CheckError::ContoursFormat(path.to_path_buf()))?;
    if inputs.iter().any(|input| is_same_file(path, input)) {
        return Err(CheckError::ContoursOverInput(path.to_path_buf()));
    }
    if let Ok(metadata) = path.symlink_metadata() {
        if !overwrite {
            return Err(CheckError::ContoursExist(path.to_path_buf()));
        }
        if metadata.permissions().readonly() {
            return Err(CheckError::ContoursProtected(path.to_path_buf()));
        }
    }
    Ok(format)
}

fn write_contours(path: &Path, format: FileFormat, analysis: &Analysis) -> io::Result<()> {
    let mut out = BufWriter::new(File::create(path)?);
    match format {
        FileFormat::Ply => write_contours_ply(&analysis.paths, &mut out)?,
        _ => write_contours_obj(&analysis.paths, &mut out)?,
    }
    out.flush()
}

/// Measures stages, one at a time.
#[derive(Debug, Default)]
struct StageClock {
    running: Option<(&'static str, Instant)>,
    times: StageTimes,
}

impl StageClock {
    fn start(&mut self, stage: &'static str) {
        self.end();
        self.running = Some((stage, Instant::now()));
    }
}

impl StageObserver for StageClock {
    fn begin(&mut self, stage: Stage) {
        self.start(match stage {
            Stage::Intersect => "intersect",
            Stage::Paths => "paths",
            Stage::Regions => "regions",
            Stage::Correspond => "correspond",
            Stage::Respond => "respond",
        });
    }

    fn end(&mut self) {
        if let Some((stage, start)) = self.running.take() {
            self.times.add(stage, start.elapsed());
        }
    }
}
