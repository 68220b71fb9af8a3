//! `untangled check --cache`: each frame, and the totals.

use serde::Serialize;

use super::{
    SCHEMA,
    error::SequenceError,
    pipeline::Pipeline,
    progress::FrameProgress,
    shot::{Asks, Judgement, Shot},
};
use crate::cli::{
    check::CheckArgs,
    fix::Counts,
    gap::GapReport,
    outcome::{self, Outcome},
    wording::{Counted, json_line},
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
    /// Whether nothing intersects, is on the wrong side, or nearer than the gap.
    clean: bool,
}

/// The line of the totals.
#[derive(Clone, Debug, Serialize)]
struct TotalsLine {
    schema: &'static str,
    totals: Totals,
}

#[derive(Clone, Debug, Serialize)]
struct Totals {
    /// The cache as it was named; bytes that are not UTF-8 are replaced.
    cache: String,
    first_frame: u64,
    last_frame: u64,
    num_frames: u64,
    num_clean_frames: u64,
    /// The sum over all frames.
    num_face_pairs: usize,
    /// Whether all frames are.
    clean: bool,
}

impl FrameLine {
    fn new(frame: u64, time_code: Option<f64>, Judgement { counts, gap }: &Judgement) -> Self {
        let clean = counts.is_clean() && gap.as_ref().is_none_or(GapReport::is_kept);
        Self { schema: SCHEMA, frame, time_code, before: counts.clone(), gap: gap.clone(), clean }
    }

    /// The line for people; nothing to say of a clean frame.
    fn words(&self) -> String {
        if self.clean {
            return String::new();
        }
        let Self { frame, before, gap, .. } = self;
        let mut words = vec![Counted(before.num_face_pairs, "intersecting face pair").to_string()];
        if let Some(bodies) = before.bodies {
            words.push(format!("{} inside of a body", Counted(bodies.num_vertices_inside_body, "vertex")));
        }
        let num_behind: usize = before.layers.iter().flatten().map(|layer| layer.num_vertices_behind).sum();
        if num_behind > 0 {
            words.push(format!("{} behind an inner layer", Counted(num_behind, "vertex")));
        }
        if let Some(gap) = gap {
            words.push(format!("{} nearer than the gap", Counted(gap.num_pairs_below, "primitive pair")));
        }
        format!("  frame {frame}: {}\n", words.join(", "))
    }
}

impl Totals {
    fn add(&mut self, line: &FrameLine) {
        self.num_frames += 1;
        self.num_clean_frames += u64::from(line.clean);
        self.num_face_pairs += line.before.num_face_pairs;
        self.clean &= line.clean;
    }

    fn words(&self) -> String {
        let Self { num_frames, num_clean_frames, .. } = self;
        format!("  {num_clean_frames} of {num_frames} frames are clean\n")
    }
}

/// Runs `check` on the frames of a cache.
///
/// # Errors
/// [`SequenceError`]; one line, exit code 2.
pub fn check(args: &CheckArgs) -> Result<Outcome, SequenceError> {
    refuse(args)?;
    let shot = Shot::open(Asks {
        files: &args.files,
        roles: &args.roles,
        sequence: &args.sequence,
        weld: args.weld,
        max_face_pairs: args.max_face_pairs,
        gap: args.gap.asked(),
    })?;
    let part = shot.part.clone();
    let [first_frame, last_frame] = [*part.start(), *part.end()];
    let cache = shot.cache.path().display().to_string();
    let mut totals =
        Totals { cache, first_frame, last_frame, num_frames: 0, num_clean_frames: 0, num_face_pairs: 0, clean: true };
    let print = |text: &str| outcome::print(text).map(|_| ()).map_err(SequenceError::Print);
    if !args.json {
        print(&outcome::printable(&format!("{}, frames {first_frame} to {last_frame}\n", totals.cache)))?;
    }
    let mut progress = FrameProgress::new(last_frame - first_frame + 1);
    let pipeline = Pipeline { frames: shot.cache.frames(), part, num_stages: 1, window: 0 };
    let judge = |_: usize, frame: u64, _: &_| {
        let (own, roles) = shot.read(frame)?;
        shot.judge(frame, &shot.state(frame, &roles, own.positions())?)
    };
    pipeline.run(&judge, &mut |frame, judgement: &Judgement| {
        let line = FrameLine::new(frame, shot.cache.time_code(frame), judgement);
        totals.add(&line);
        progress.done(frame);
        print(&if args.json { json_line(&line) } else { line.words() })
    })?;
    drop(progress);
    let clean = totals.clean;
    print(&if args.json { json_line(&TotalsLine { schema: SCHEMA, totals }) } else { totals.words() })?;
    Ok(if clean { Outcome::Clean } else { Outcome::Remaining })
}

/// Refuses arguments that mean nothing for a sequence.
fn refuse(args: &CheckArgs) -> Result<(), SequenceError> {
    let refused = [
        (args.face_pairs, "--face-pairs", "check one frame as a mesh file for its pairs"),
        (args.contours.is_some(), "--contours", "check one frame as a mesh file for its paths"),
        (args.overwrite, "--overwrite", "check writes no file of a sequence"),
        (args.verbose, "--verbose", "frames are checked side by side, so their stages have no times of their own"),
    ];
    match refused.into_iter().find(|(is_given, ..)| *is_given) {
        Some((_, argument, reason)) => Err(SequenceError::Argument { argument, reason }),
        None => Ok(()),
    }
}
