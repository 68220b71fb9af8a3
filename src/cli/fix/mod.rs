//! `untangled fix`: untangles mesh files and writes them back.
//!
//! Each module uses those above it in this table only.
//!
//! | module | purpose |
//! |---|---|
//! | `args`, `error` | the arguments; why nothing was written |
//! | `pins` | the pin file |
//! | `target` | the place of a file, and replacing it in one step |
//! | `plan` | what is written where |
//! | `report` | counts, distortion and history, as JSON and as text |
//! | `terminal` | the progress line and Ctrl-C |
//! | `view` | what a round relaxes: the state as its files hold it, or as another reader sees it |
//! | `repair` | relax, write, read back, check |
//! | `clearance` | the same for a gap, once nothing intersects |

pub(super) mod args;
mod clearance;
mod error;
pub(super) mod pins;
mod plan;
mod repair;
mod report;
mod target;
mod terminal;
#[cfg(test)]
mod tests;
mod view;

use std::time::Instant;

use untangle::{
    analysis::Analysis,
    relax::{RelaxSettings, relax_until},
};
use untangled_mesh_io::MeshFile;

pub use args::{FixArgs, QualityArg};
pub use error::FixError;
pub use report::{Blocked, Counts, Distortion, ImpliedOrder, LayerChange, Report};

use super::{
    certificate::Certificate,
    gap::GapReport,
    html::{ChangeData, MeshData, PageData, StateData, settings_of_fix},
    input::{self, Input, analyse_within},
    outcome::{self, Outcome},
    owners::Owners,
    roles::Roles,
};
pub(super) use clearance::Clearing;
use plan::{Job, Plan, check_movable, plan};
pub(super) use repair::{Repair, Repaired, Store, rank};
use repair::{Solver, Written};
use target::Staged;
pub(super) use target::Target;
pub(super) use terminal::{Interrupt, Progress};

/// Runs the subcommand: prints the report on standard output.
///
/// # Errors
/// [`FixError`]; one line, exit code 2.
pub fn run(args: &FixArgs) -> Result<Outcome, FixError> {
    let interrupt = Interrupt::listen().map_err(FixError::Signals)?;
    let Fixed { report, page } = fix(args, &mut relax_until, &interrupt)?;
    let text = if args.json { report.to_json() } else { outcome::printable(&report.to_string()) };
    outcome::print(&text).map_err(FixError::Print)?;
    page?;
    Ok(if report.clean { Outcome::Clean } else { Outcome::Remaining })
}

/// What was done.
#[derive(Debug)]
struct Fixed {
    report: Report,
    /// Whether the page was written, if one was asked for.
    page: Result<(), FixError>,
}

/// Untangles and writes files. Nothing is at its place before everything is written, but for the page: that is made of
/// what is there, and withholds nothing.
fn fix(args: &FixArgs, solver: Solver<'_>, interrupt: &Interrupt) -> Result<Fixed, FixError> {
    let start = Instant::now();
    let mut progress = Progress::new();
    progress.say("reading");
    let files = input::read_files(&args.world.files)?;
    let roles = Roles::read(&args.world.roles, &files, args.world.weld)?;
    let Plan { jobs, report: report_target, page: page_target } = plan(args, &files, &roles)?;
    let (input, pins) = world(args, &files, &roles)?;
    interrupt.check()?;
    progress.say("analysing");
    let (before, found) = count(args, &files, &roles, &input)?;
    interrupt.check()?;
    let deadline = args.time_limit.and_then(|limit| start.checked_add(limit));
    let (store, settings) = (Store::Files(&jobs), settings(args, &jobs));
    let repair = Repair { files: &files, roles: &roles, store, pins: &pins, settings, deadline };
    let owners = Owners::new(files.iter().chain(&roles.bodies));
    let clearing = Clearing { repair: &repair, asked: args.world.gap.asked(), input: &input, owners: &owners };
    let (repaired, gap) = untangle(&clearing, &jobs, &before, solver, interrupt, &mut progress)?;
    let Repaired { written, history, mut blocked, time_limit_reached } = repaired;
    Blocked::name_owners(&mut blocked, &owners);
    let Written { staged, input: read_back, counts: after, analysis: left } = written;
    let report = Report {
        schema: "untangled.fix/1",
        files: args.world.files.iter().map(|path| path.display().to_string()).collect(),
        outputs: jobs.iter().map(|job| job.target.path.display().to_string()).collect(),
        clean: after.is_certified() && gap.as_ref().is_none_or(GapReport::is_kept),
        bodies: roles.reports(),
        layers: LayerChange::of(&before, &after),
        implied_order: ImpliedOrder::of(&input, &found.intersections, &read_back, &owners),
        num_welded_vertices: input.weld.num_merged(),
        num_zeroed_coordinates: input.num_zeroed_coordinates(),
        time_limit_reached,
        num_iterations: history.len(),
        seconds: start.elapsed().as_secs_f64(),
        before,
        after,
        gap,
        distortion: Distortion::new(&input, &read_back.positions),
        blocked,
        history,
    };
    persist(&report, staged, report_target, interrupt)?;
    let page = page_target.map_or(Ok(()), |target| {
        progress.say("writing the page");
        let states = [State(&input, &found), State(&read_back, &left)];
        write_page(args, (&files, &roles, &pins), states, &report, &target, interrupt)
    });
    Ok(Fixed { report, page })
}

/// Untangles and opens the gap, or writes a clean input as it is.
fn untangle(
    clearing: &Clearing<'_>,
    jobs: &[Job<'_>],
    before: &Counts,
    solver: Solver<'_>,
    interrupt: &Interrupt,
    progress: &mut Progress,
) -> Result<(Repaired, Option<GapReport>), FixError> {
    let Clearing { repair, input, .. } = clearing;
    let repaired = if before.is_certified() {
        Repaired::unchanged(repair.write(input, &input.positions, interrupt)?)
    } else {
        check_movable(jobs, input)?;
        progress.say("untangling");
        repair.run(input, before, solver, interrupt, progress)?
    };
    clearing.run(repaired, interrupt, progress)
}

/// A state, and what was found in it.
struct State<'a>(&'a Input, &'a Analysis);

/// Writes the page. The world are the files, the bodies and the pinned vertices.
fn write_page(
    args: &FixArgs,
    (files, roles, pins): (&[MeshFile], &Roles, &[u32]),
    [State(before, found), State(after, left)]: [State<'_>; 2],
    report: &Report,
    target: &Target,
    interrupt: &Interrupt,
) -> Result<(), FixError> {
    let mesh = MeshData::new(files, roles, before, pins);
    let centre = mesh.centre;
    let mut page = PageData::new("fix", outcome::printable(&report.to_string()), report, mesh);
    page.settings = settings_of_fix(args);
    page.states =
        vec![StateData::new("before", before, found, centre, true), StateData::new("after", after, left, centre, true)];
    page.change = Some(ChangeData::new(before, &after.positions));
    page.write(target, interrupt)
}

/// Puts all files at their places, the report among them.
fn persist(
    report: &Report,
    staged: Vec<Staged>,
    report_target: Option<Target>,
    interrupt: &Interrupt,
) -> Result<(), FixError> {
    let report_file = report_target.map(|target| {
        target
            .stage(interrupt, |out| out.write_all(report.to_json().as_bytes()).map_err(|source| target.failed(&source)))
    });
    let report_file = report_file.transpose()?;
    interrupt.commit()?;
    staged.into_iter().chain(report_file).try_for_each(Staged::persist)
}

/// Counts what intersects in the input.
fn count(args: &FixArgs, files: &[MeshFile], roles: &Roles, input: &Input) -> Result<(Counts, Analysis), FixError> {
    let analysis = analyse_within(&args.world.files, input, args.world.max_face_pairs, &mut ())?;
    Ok((Counts::new(&analysis, roles, input, Certificate::of(files, roles, input)), analysis))
}

/// The files and the bodies as one world, and the pinned vertices of the files.
fn world(args: &FixArgs, files: &[MeshFile], roles: &Roles) -> Result<(Input, Vec<u32>), FixError> {
    let mut world = roles.join(&args.world.files, files)?;
    let num_vertices = files.iter().map(|file| file.positions().len()).sum();
    let pins = args.pin.as_deref().map(|path| pins::read(path, num_vertices)).transpose()?.unwrap_or_default();
    world.description.pins.clone_from(&pins);
    Ok((Input::new(files, world, args.world.weld)?.decided(), pins))
}

fn settings(args: &FixArgs, jobs: &[Job<'_>]) -> RelaxSettings {
    RelaxSettings {
        effort: args.quality.into(),
        max_iterations: args.max_iterations,
        // One file of double precision is reason enough not to round: rounding would change its digits.
        single_precision: jobs.iter().all(|job| job.output.is_single_precision()),
        other_attempts: true,
    }
}
