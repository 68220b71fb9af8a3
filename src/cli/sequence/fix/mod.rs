//! `untangled fix --cache`: repairs the frames of a shot, coherent in time, and writes them.
//!
//! Each module uses those above it in this table only.
//!
//! | module | purpose |
//! |---|---|
//! | `single` | the repair of one state of one frame |
//! | `passes` | passes over the frames, by which corrections become smooth in time |
//! | `report` | the line of a frame, and the totals |
//! | `journal` | which frames are done, for the next run |
//! | `output` | where frames are written |
//! | `identity` | the inputs and settings of a run |

mod identity;
mod journal;
mod output;
mod passes;
mod report;
mod single;

use std::{
    io::{self, Write},
    sync::Arc,
};

use untangle::coherence::RoughnessMeter;

use super::{SCHEMA, error::SequenceError, page::ShotPage, pipeline::Pipeline, progress::FrameProgress, shot::Shot};
use crate::cli::{
    fix::{FixArgs, FixError, Interrupt, Target, pins},
    html::settings_of_fix,
    outcome::{self, Outcome},
    wording::json_line,
};
use journal::{Earlier, Entry, Identity, Journal};
use output::Output;
use passes::{FADE, NUM_SPREADS, Pass};
use report::{FrameLine, Totals, TotalsLine};
use single::Repairer;

const INTERRUPTED: &str = "interrupted; the frames that are finished stay, and the same command goes on from there";

/// Runs `fix` on the frames of a cache.
///
/// # Errors
/// [`SequenceError`]; one line, exit code 2.
pub fn fix(args: &FixArgs) -> Result<Outcome, SequenceError> {
    refuse(args)?;
    let interrupt = Interrupt::listen_saying(INTERRUPTED).map_err(FixError::Signals)?;
    let shot = open(args)?;
    let inputs = inputs(args, &shot);
    let paths: Vec<_> = inputs.iter().map(AsRef::as_ref).collect();
    let report = args.report.clone().map(|path| Target::new(path, &paths, args.overwrite)).transpose()?;
    let page = args.html.as_deref().map(|path| {
        let page = ShotPage::new(&shot, &["before", "after"], path, &paths, args.overwrite)?;
        if report.as_ref().is_some_and(|report| report.is_same_place(page.target())) {
            let reason = "is the report, and can't be the page as well".to_owned();
            return Err(SequenceError::from(FixError::Target { path: path.to_path_buf(), reason }));
        }
        Ok(page)
    });
    let page = page.transpose()?;
    let output = Output::new(&shot, &args.out, args.overwrite, &inputs)?;
    let identity = identity::identity(args, &shot)?;
    let (journal, done) = resume(&shot, &output, &identity, &inputs)?;
    let repairer = Repairer {
        shot: &shot,
        effort: args.quality.into(),
        max_iterations: args.max_iterations,
        interrupt: &interrupt,
    };
    let mut run = Run::new(args, &shot, output, journal);
    run.page = page;
    run.begin()?;
    let next = shot.part.start() + done.len() as u64;
    for entry in done {
        run.replay(&repairer, entry)?;
    }
    if next <= *shot.part.end() {
        let (frames, part) = (shot.cache.frames(), next..=*shot.part.end());
        let pipeline = Pipeline { frames, part, num_stages: NUM_SPREADS + 1, window: FADE.num_frames };
        let progress = Arc::clone(&run.progress);
        let work = |number: usize, frame: u64, window: &_| {
            progress.begin(number, frame);
            repairer.pass(number, frame, window)
        };
        pipeline.run(&work, &mut |frame, pass: &Pass| run.take(frame, pass))?;
    }
    run.finish(args, report, &interrupt)
}

fn open(args: &FixArgs) -> Result<Shot, SequenceError> {
    let mut shot = Shot::open(&args.world)?;
    let num_vertices = shot.files.iter().map(|file| file.positions().len()).sum();
    let pins = args.pin.as_deref().map(|path| pins::read(path, num_vertices)).transpose()?;
    shot.pins = pins.unwrap_or_default();
    shot.certify_gap = true;
    Ok(shot)
}

/// All files that are read.
fn inputs(args: &FixArgs, shot: &Shot) -> Vec<std::path::PathBuf> {
    let own = shot.source_files().into_iter().map(ToOwned::to_owned).chain(args.pin.clone());
    own.chain(shot.cache_files()).collect()
}

/// Opens the journal, and finds what an earlier run has done.
fn resume(
    shot: &Shot,
    output: &Output,
    identity: &Identity,
    inputs: &[std::path::PathBuf],
) -> Result<(Journal, Vec<Entry>), SequenceError> {
    let first = *shot.part.start();
    let (mut journal, Earlier { done, other }) = Journal::open(output.journal(&shot.part), identity)?;
    let done = output.confirmed(first, done);
    // Nobody may be there to read it.
    if let Some((_, name)) = &other {
        let _ = writeln!(io::stderr(), "untangled: the run that was ended here had another {name}: starting anew");
    } else if !done.is_empty() {
        let frames = done.len();
        let _ = writeln!(io::stderr(), "untangled: going on after {frames} frames that an earlier run finished");
    }
    let own = other.map(|(entries, _)| entries).unwrap_or_default();
    let is_new = done.is_empty() && own.is_empty();
    if let Err(error) = output.begin(first + done.len() as u64..=*shot.part.end(), &own, inputs) {
        if is_new {
            journal.remove()?;
        }
        return Err(error);
    }
    journal.begin(identity, &done)?;
    Ok((journal, done))
}

/// Refuses arguments that mean nothing for a sequence.
fn refuse(args: &FixArgs) -> Result<(), SequenceError> {
    if args.time_limit.is_some() {
        let reason =
            "frames must not depend on the speed of the machine; end the run by Ctrl-C, it can be gone on with";
        return Err(SequenceError::Argument { argument: "--time-limit", reason });
    }
    Ok(())
}

/// A run under way.
struct Run<'a> {
    is_json: bool,
    keeps_lines: bool,
    shot: &'a Shot,
    output: Output,
    journal: Journal,
    progress: Arc<FrameProgress>,
    meter: RoughnessMeter,
    totals: Totals,
    /// All lines, for the report.
    lines: String,
    page: Option<ShotPage>,
}

impl<'a> Run<'a> {
    fn new(args: &FixArgs, shot: &'a Shot, output: Output, journal: Journal) -> Self {
        let [first_frame, last_frame] = [*shot.part.start(), *shot.part.end()];
        let largest = shot.reference.iter().flatten().fold(0.0f64, |a, b| a.max(b.abs()));
        let totals = Totals {
            cache: shot.cache.path().display().to_string(),
            output: args.out.display().to_string(),
            first_frame,
            last_frame,
            num_vertices: shot.files.iter().map(|file| file.positions().len()).sum(),
            fade_frames: FADE.num_frames,
            ..Totals::default()
        };
        Self {
            is_json: args.json,
            keeps_lines: args.report.is_some(),
            shot,
            output,
            journal,
            progress: Arc::new(FrameProgress::new(last_frame - first_frame + 1, NUM_SPREADS + 1)),
            meter: RoughnessMeter::new(FADE, largest * f64::from(f32::EPSILON)),
            totals,
            lines: String::new(),
            page: None,
        }
    }

    fn begin(&mut self) -> Result<(), SequenceError> {
        let Totals { cache, output, first_frame, last_frame, .. } = &self.totals;
        let head = format!("{cache} -> {output}, frames {first_frame} to {last_frame}\n");
        if let Some(page) = &mut self.page {
            page.say(&head);
        }
        if self.is_json { Ok(()) } else { print(&outcome::printable(&head)) }
    }

    /// Writes a frame and reports it.
    fn take(&mut self, frame: u64, pass: &Pass) -> Result<(), SequenceError> {
        let own = self.shot.cache.read(frame)?;
        let mut positions = own.positions().to_vec();
        for (&vertex, place) in &pass.moved {
            positions[vertex as usize] = *place;
        }
        let bytes = own.encode(&positions).map_err(|source| self.shot.failed(frame, source))?;
        let is_same = |(a, b): (&[f64; 3], &[f64; 3])| a.map(f64::to_bits) == b.map(f64::to_bits);
        let back = self.shot.cache.decode(frame, bytes.clone())?;
        if !back.positions().iter().zip(&positions).all(is_same) {
            return Err(SequenceError::ReadBack { path: self.shot.cache.file(frame), frame });
        }
        self.output.write(frame, &bytes)?;
        let entry =
            Entry::new(frame, &bytes, json_line(&FrameLine::new(frame, self.shot.cache.time_code(frame), pass)));
        self.journal.add(&entry)?;
        self.output.place(frame)?;
        self.meter.push(pass.correction.clone());
        self.report(frame, &entry.line)?;
        self.show(frame, &entry.line, own.positions(), &positions)
    }

    /// Reports a frame that an earlier run wrote.
    fn replay(&mut self, repairer: &Repairer<'_>, entry: Entry) -> Result<(), SequenceError> {
        let frame = entry.frame;
        let bytes = self.output.read(frame).unwrap_or_default();
        let written = self.shot.cache.decode(frame, bytes)?;
        self.meter.push(repairer.correction_of(frame, written.positions())?);
        self.report(frame, &entry.line)?;
        let own = self.shot.cache.read(frame)?;
        self.show(frame, &entry.line, own.positions(), written.positions())
    }

    fn report(&mut self, frame: u64, line: &str) -> Result<(), SequenceError> {
        let value = serde_json::from_str(line).unwrap_or_default();
        self.totals.add(&value);
        self.progress.done(frame);
        if self.keeps_lines {
            self.lines.push_str(line);
        }
        if self.is_json { print(line) } else { print(&report::words(&value)) }
    }

    /// Takes a frame into the page, if there is one: what is in both states is searched once more for it.
    fn show(&mut self, frame: u64, line: &str, before: &[[f64; 3]], after: &[[f64; 3]]) -> Result<(), SequenceError> {
        let Some(page) = &mut self.page else { return Ok(()) };
        let (_, roles) = self.shot.read(frame)?;
        let state = |positions: &[[f64; 3]]| -> Result<_, SequenceError> {
            let state = self.shot.state(frame, &roles, positions)?;
            let analysis = self.shot.analyse(frame, &state)?;
            Ok((state, analysis))
        };
        let [before, after] = [state(before)?, state(after)?];
        let value = serde_json::from_str(line).unwrap_or_default();
        let words = report::words(&value);
        page.push(frame, value, &words, &[(&before.0, &before.1), (&after.0, &after.1)]);
        Ok(())
    }

    /// Puts everything at its place.
    fn finish(
        mut self,
        args: &FixArgs,
        report: Option<Target>,
        interrupt: &Interrupt,
    ) -> Result<Outcome, SequenceError> {
        self.totals.finish(self.meter.roughness());
        let (clean, words) = (self.totals.clean, self.totals.words());
        let line = TotalsLine { schema: SCHEMA, totals: self.totals };
        let totals = json_line(&line);
        drop(self.progress);
        if let Some(target) = report {
            let lines = self.lines + &totals;
            let write = |out: &mut dyn Write| out.write_all(lines.as_bytes()).map_err(|source| target.failed(&source));
            target.stage(interrupt, write)?.persist()?;
        }
        self.output.finish(self.shot, interrupt)?;
        self.journal.remove()?;
        if let Some(page) = &mut self.page {
            page.say(&words);
        }
        print(&if self.is_json { totals } else { words })?;
        if let Some(page) = self.page {
            // There is nothing left to go on with.
            interrupt.commit()?;
            page.write(self.shot, ("fix", settings_of_fix(args)), &line, interrupt)?;
        }
        Ok(if clean { Outcome::Clean } else { Outcome::Remaining })
    }
}

fn print(text: &str) -> Result<(), SequenceError> {
    outcome::print(text).map(|_| ()).map_err(SequenceError::Print)
}
