//! `untangled check`: analyses mesh files and says what intersects.

pub(super) mod args;
mod error;
mod meetings;
pub(super) mod pairs;
pub(super) mod report;
#[cfg(test)]
mod tests;

use std::{
    fs::File,
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
    time::Instant,
};

pub use args::CheckArgs;
pub use error::CheckError;
pub use report::Report;

use untangle::{
    analysis::Analysis,
    stage::{Stage, StageObserver},
};
use untangled_mesh_io::{FileFormat, MeshFile, write_contours_obj, write_contours_ply};

use super::{
    certificate::Certificate,
    fix::{FixError, Interrupt, Target},
    gap::{Asked, GapReport},
    html::{MeshData, PageData, StateData, page_target, settings_of_check},
    input::{self, Input, MAX_FACE_PAIRS, analyse_within, is_same_file},
    outcome::{self, Outcome},
    owners::Owners,
    roles::{BodyCounts, LayerReport, RoleArgs, Roles},
    weld::WeldArg,
};
use meetings::Meeting;
use report::StageTimes;

/// Files as they were read, and what was found in them.
struct Checked {
    meshes: Vec<MeshFile>,
    roles: Roles,
    input: Input,
    analysis: Analysis,
    report: Report,
}

/// Runs the subcommand: prints the report on standard output.
///
/// # Errors
/// [`CheckError`]; one line, exit code 2.
pub fn run(args: &CheckArgs) -> Result<Outcome, CheckError> {
    let inputs = [args.world.files.as_slice(), &args.world.roles.bodies].concat();
    let contours = args.contours.as_deref().map(|path| contours_format(path, &inputs, args.overwrite)).transpose()?;
    // Before time is spent, and again once it is known which files were read.
    page_place(args, inputs.iter().map(PathBuf::as_path))?;
    let mut checked = check_within(
        &args.world.files,
        &args.world.roles,
        args.world.weld,
        args.face_pairs,
        args.world.max_face_pairs,
        args.world.gap.asked(),
    )?;
    checked.report.verbose = args.verbose;
    let Checked { analysis, report, meshes, roles, .. } = &checked;
    let text = if args.json { report.to_json() } else { outcome::printable(&report.to_string()) };
    outcome::print(&text).map_err(|source| CheckError::Write { path: "standard output".into(), source })?;
    // Neither of these, where it can't be written, withholds the report or the other.
    let contours = args.contours.as_ref().zip(contours).map_or(Ok(()), |(path, format)| {
        write_contours(path, format, analysis).map_err(|source| CheckError::Write { path: path.clone(), source })
    });
    let read = meshes.iter().chain(&roles.bodies).flat_map(MeshFile::source_files);
    if let Some(target) = page_place(args, read)? {
        write_page(args, &target, &checked).map_err(Box::new)?;
    }
    contours?;
    let is_too_close = report.gap.as_ref().is_some_and(|gap| gap.num_pairs_below > 0);
    Ok(if report.is_clean() && !is_too_close { Outcome::Clean } else { Outcome::Remaining })
}

/// Where the page goes, if one was asked for.
fn page_place<'a>(args: &CheckArgs, inputs: impl Iterator<Item = &'a Path>) -> Result<Option<Target>, CheckError> {
    let inputs: Vec<&Path> = inputs.collect();
    let target = args.html.as_deref().map(|path| page_target(path, &inputs, args.overwrite));
    Ok(target.transpose().map_err(Box::new)?)
}

fn write_page(args: &CheckArgs, target: &Target, checked: &Checked) -> Result<(), FixError> {
    let Checked { meshes, roles, input, analysis, report } = checked;
    let mesh = MeshData::new(meshes, roles, input, &[]);
    let state = StateData::new("check", input, analysis, mesh.centre, false);
    let mut page = PageData::new("check", outcome::printable(&report.to_string()), report, mesh);
    page.settings = settings_of_check(args);
    page.states = vec![state];
    page.write(target, &Interrupt::listen().map_err(FixError::Signals)?)
}

/// Reads and analyses files as one world, with the usual limit on what may intersect.
///
/// # Errors
/// [`CheckError`], naming the file and the element at fault.
pub fn check(files: &[PathBuf], weld: WeldArg, list_face_pairs: bool) -> Result<(Report, Analysis), CheckError> {
    let checked = check_within(files, &RoleArgs::default(), weld, list_face_pairs, MAX_FACE_PAIRS, None)?;
    Ok((checked.report, checked.analysis))
}

fn check_within(
    files: &[PathBuf],
    roles: &RoleArgs,
    weld: WeldArg,
    list_face_pairs: bool,
    max_face_pairs: u64,
    gap: Option<Asked>,
) -> Result<Checked, CheckError> {
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
    Ok(Checked { meshes, roles, input, analysis, report })
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
