//! `untangled check --cache`: each frame, and the totals.

use serde::Serialize;

use untangle::analysis::Analysis;

use super::{
    SCHEMA,
    error::SequenceError,
    page::ShotPage,
    pipeline::Pipeline,
    progress::FrameProgress,
    shot::{Judgement, Shot, State},
    words,
};
use crate::cli::{
    check::CheckArgs,
    fix::{Counts, FixError, Interrupt},
    gap::GapReport,
    html::settings_of_check,
    outcome::{self, Outcome},
    wording::json_line,
};

/// The line of a frame.
#[derive(Clone, Debug, Serialize)]
struct FrameLine {
    schema: &'static str,
    /// Its number: in the name of its file, or from 0.
    frame: u64,
    /// Its time code in USD.
    #[serde(skip_serializing_if = "Option::is_none")]
    time_code: Option<f64>,
    /// What is in it.
    before: Counts,
    /// The distances, if a gap was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    gap: Option<GapReport>,
    /// Coordinates below 2^-250 m, which count as zero.
    num_zeroed_coordinates: usize,
    /// Whether nothing intersects, is on the wrong side, or nearer than the gap.
    clean: bool,
}

/// The line of the totals.
#[derive(Clone, Debug, Serialize)]
struct TotalsLine {
    schema: &'static str,
    totals: Totals,
}

#[derive(Clone, Debug, Default, Serialize)]
struct Totals {
    /// The cache as it was named; bytes that are not UTF-8 are replaced.
    cache: String,
    first_frame: u64,
    last_frame: u64,
    num_frames: u64,
    num_clean_frames: u64,
    /// The sum over all frames.
    num_face_pairs: usize,
    /// The same of coordinates that count as zero.
    num_zeroed_coordinates: usize,
    /// Whether all frames are.
    clean: bool,
}

impl FrameLine {
    fn new(frame: u64, time_code: Option<f64>, judgement: &Judgement) -> Self {
        let Judgement { counts, gap, num_zeroed_coordinates } = judgement.clone();
        let clean = counts.is_clean() && gap.as_ref().is_none_or(GapReport::is_kept);
        Self { schema: SCHEMA, frame, time_code, before: counts, gap, num_zeroed_coordinates, clean }
    }

    /// The lines for people; nothing to say of a frame that is clean for every reader.
    fn words(&self) -> String {
        let line = serde_json::to_value(self).unwrap_or_default();
        let (counts, gap, frame) = (&line["before"], &line["gap"], self.frame);
        let readers = words::by_readers("but not for every reader", counts, gap);
        let faults = words::faults(counts, &gap["num_pairs_below"]);
        let found: Vec<String> = faults.iter().filter(|fault| fault.count > 0).map(words::Fault::words).collect();
        match (found.is_empty(), readers.is_empty()) {
            (false, _) => format!("  frame {frame}: {}\n", found.join(", ")),
            (true, false) => format!("  frame {frame}: clean,\n{readers}"),
            (true, true) => String::new(),
        }
    }
}

impl Totals {
    fn add(&mut self, line: &FrameLine) {
        self.num_frames += 1;
        self.num_clean_frames += u64::from(line.clean);
        self.num_face_pairs += line.before.num_face_pairs;
        self.num_zeroed_coordinates += line.num_zeroed_coordinates;
        self.clean &= line.clean;
    }

    fn words(&self) -> String {
        let Self { num_frames, num_clean_frames, .. } = self;
        let zeroed = words::zeroed_line(self.num_zeroed_coordinates);
        format!("{zeroed}  {num_clean_frames} of {num_frames} frames are clean\n")
    }
}

/// Runs `check` on the frames of a cache.
///
/// # Errors
/// [`SequenceError`]; one line, exit code 2.
pub fn check(args: &CheckArgs) -> Result<Outcome, SequenceError> {
    refuse(args)?;
    let shot = Shot::open(&args.world)?;
    let part = shot.part.clone();
    let [first_frame, last_frame] = [*part.start(), *part.end()];
    let cache = shot.cache.path().display().to_string();
    let mut totals = Totals { cache, first_frame, last_frame, clean: true, ..Totals::default() };
    let print = |text: &str| outcome::print(text).map(|_| ()).map_err(SequenceError::Print);
    let head = format!("{}, frames {first_frame} to {last_frame}\n", totals.cache);
    let mut page = page(args, &shot)?;
    if let Some(page) = &mut page {
        page.say(&head);
    }
    if !args.json {
        print(&outcome::printable(&head))?;
    }
    let progress = FrameProgress::new(last_frame - first_frame + 1, 1);
    let pipeline = Pipeline { frames: shot.cache.frames(), part, num_stages: 1, window: 0 };
    let is_kept = page.is_some();
    let judge = |pass: usize, frame: u64, _: &_| {
        progress.begin(pass, frame);
        judge(&shot, frame, is_kept)
    };
    pipeline.run(&judge, &mut |frame, (judgement, found): &Found| {
        let line = FrameLine::new(frame, shot.cache.time_code(frame), judgement);
        totals.add(&line);
        progress.done(frame);
        if let (Some(page), Some((state, analysis))) = (&mut page, found) {
            let value = serde_json::to_value(&line).unwrap_or_default();
            page.push(frame, value, &line.words(), &[(state, analysis)]);
        }
        print(&if args.json { json_line(&line) } else { line.words() })
    })?;
    drop(progress);
    let (clean, words) = (totals.clean, totals.words());
    let totals = TotalsLine { schema: SCHEMA, totals };
    if let Some(page) = &mut page {
        page.say(&words);
    }
    print(&if args.json { json_line(&totals) } else { words })?;
    if let Some(page) = page {
        let interrupt = Interrupt::listen().map_err(FixError::Signals)?;
        page.write(&shot, ("check", settings_of_check(args)), &totals, &interrupt)?;
    }
    Ok(if clean { Outcome::Clean } else { Outcome::Remaining })
}

/// A judgement, and what was found, where it is kept.
type Found = (Judgement, Option<(State, Analysis)>);

/// Judges a frame.
fn judge(shot: &Shot, frame: u64, is_kept: bool) -> Result<Found, SequenceError> {
    let (own, roles) = shot.read(frame)?;
    let state = shot.state(frame, &roles, own.positions())?;
    let analysis = shot.analyse(frame, &state)?;
    let judgement = shot.judge_found(frame, &state, &analysis)?;
    // What was found is only kept for a page.
    Ok((judgement, is_kept.then_some((state, analysis))))
}

/// The page, if one was asked for.
fn page(args: &CheckArgs, shot: &Shot) -> Result<Option<ShotPage>, SequenceError> {
    let files = shot.cache_files();
    let inputs: Vec<_> = shot.source_files().into_iter().chain(files.iter().map(AsRef::as_ref)).collect();
    let page = args.html.as_deref().map(|path| ShotPage::new(shot, &["check"], path, &inputs, args.overwrite));
    page.transpose()
}

/// Refuses arguments that mean nothing for a sequence.
fn refuse(args: &CheckArgs) -> Result<(), SequenceError> {
    let refused = [
        (args.face_pairs, "--face-pairs", "check one frame as a mesh file for its pairs"),
        (args.contours.is_some(), "--contours", "check one frame as a mesh file for its paths"),
        (args.overwrite && args.html.is_none(), "--overwrite", "check writes no file of a sequence but --html"),
        (args.verbose, "--verbose", "frames are checked side by side, so their stages have no times of their own"),
    ];
    match refused.into_iter().find(|(is_given, ..)| *is_given) {
        Some((_, argument, reason)) => Err(SequenceError::Argument { argument, reason }),
        None => Ok(()),
    }
}
