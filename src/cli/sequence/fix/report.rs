//! What `fix --cache` reports: a line for each frame, and the totals.

use serde::Serialize;
use serde_json::Value;

use untangle::coherence::Roughness;

use super::passes::Pass;
use crate::cli::{
    fix::{Blocked, Counts},
    gap::GapReport,
    sequence::{
        SCHEMA,
        shot::Judgement,
        words::{self, number},
    },
    wording::Counted,
};

/// The line of a frame.
#[derive(Clone, Debug, Serialize)]
pub(super) struct FrameLine {
    schema: &'static str,
    /// Its number: in the name of its file, or from 0.
    frame: u64,
    /// Its time code in USD.
    #[serde(skip_serializing_if = "Option::is_none")]
    time_code: Option<f64>,
    /// What is in the input.
    before: Counts,
    /// What is in the output, read back.
    after: Counts,
    /// The distances of the output, if a gap was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    gap: Option<GapReport>,
    /// Coordinates of the input below 2^-250 m, which count as zero.
    num_zeroed_coordinates: usize,
    /// Whether the input was clean.
    clean_before: bool,
    /// Whether exact checks of the output found nothing, for all readers.
    clean: bool,
    /// Vertices that moved at all; all others are what they were, to the bit.
    num_moved_vertices: usize,
    /// Largest displacement of a vertex, in metres.
    max_displacement_m: f64,
    /// Iterations of all its repairs.
    num_iterations: usize,
    /// What could not be resolved.
    blocked: Vec<Blocked>,
}

impl FrameLine {
    pub(super) fn new(frame: u64, time_code: Option<f64>, pass: &Pass) -> Self {
        let Judgement { counts: after, gap, .. } = pass.after.clone();
        let gap = gap.map(|gap| GapReport {
            num_pairs_below_before: pass.before.gap.as_ref().map(|before| before.num_pairs_below),
            ..gap
        });
        Self {
            schema: SCHEMA,
            frame,
            time_code,
            before: pass.before.counts.clone(),
            clean: pass.after.is_clean(),
            clean_before: pass.before.is_clean(),
            after,
            gap,
            num_zeroed_coordinates: pass.before.num_zeroed_coordinates,
            num_moved_vertices: pass.moved.len(),
            // Turning changes no length.
            max_displacement_m: pass.correction.values().map(|vector| vector.norm()).fold(0.0, f64::max),
            num_iterations: pass.num_iterations,
            blocked: pass.blocked.clone(),
        }
    }
}

/// The lines for people; nothing to say of a frame that is as it was.
pub(super) fn words(line: &Value) -> String {
    let moved = number(&line["num_moved_vertices"]);
    if moved == 0 && is(line, "clean") {
        return String::new();
    }
    let (before, after, gap) = (&line["before"], &line["after"], &line["gap"]);
    let faults = [words::faults(before, &gap["num_pairs_below_before"]), words::faults(after, &gap["num_pairs_below"])];
    let largest_mm = 1000.0 * line["max_displacement_m"].as_f64().unwrap_or(0.0);
    let how = match (is(line, "clean_before"), is(line, "clean")) {
        (true, true) => "clean, and carries a part of the correction beside it".to_owned(),
        (_, is_clean) => format!("{}: {}", if is_clean { "clean" } else { "not clean" }, changes(&faults)),
    };
    let moved = Counted(moved, "vertex");
    let own = format!("  frame {}: {how}; {moved} moved, by up to {largest_mm:.2} mm\n", number(&line["frame"]));
    let is_certain = faults[0].iter().any(|fault| fault.count > 0);
    let earlier = if is_certain {
        String::new()
    } else {
        words::by_readers("the input is clean as it is, but not for every reader", before, &Value::Null)
    };
    own + &earlier + &words::by_readers("what readers of the output find", after, gap)
}

/// What became of each kind of fault that there was or is; of intersections always.
fn changes([before, after]: &[[words::Fault; 4]; 2]) -> String {
    let pairs = before.iter().zip(after).enumerate();
    let pairs = pairs.filter(|(kind, (before, after))| *kind == 0 || before.count + after.count > 0);
    let change = |(_, (before, after)): (usize, (&words::Fault, &words::Fault))| {
        format!("{} became {}", before.words(), after.count)
    };
    pairs.map(change).collect::<Vec<_>>().join(", ")
}

fn is(line: &Value, name: &str) -> bool {
    line[name].as_bool().unwrap_or(false)
}

/// The line of the totals.
#[derive(Clone, Debug, Serialize)]
pub(super) struct TotalsLine {
    pub(super) schema: &'static str,
    pub(super) totals: Totals,
}

/// What there is to say of all frames.
#[derive(Clone, Debug, Default, Serialize)]
pub(super) struct Totals {
    /// The cache as it was named; bytes that are not UTF-8 are replaced.
    pub(super) cache: String,
    /// The output, named in the same way.
    pub(super) output: String,
    pub(super) first_frame: u64,
    pub(super) last_frame: u64,
    pub(super) num_frames: usize,
    /// Frames that were clean.
    pub(super) num_clean_frames_before: usize,
    /// Frames that are clean.
    pub(super) num_clean_frames: usize,
    /// Frames that are what they were, bit for bit.
    pub(super) num_unchanged_frames: usize,
    pub(super) num_vertices: usize,
    /// Vertices that are what they were in all frames, bit for bit.
    pub(super) num_unchanged_vertices: usize,
    /// Coordinates of the input in all frames that are so small that they count as zero.
    pub(super) num_zeroed_coordinates: usize,
    /// Frames beside a repaired one that carry a part of its correction.
    pub(super) fade_frames: u64,
    /// How smooth the corrections are in time.
    pub(super) smoothness: Roughness,
    /// Whether all frames are clean.
    pub(super) clean: bool,
}

impl Totals {
    /// Counts a frame.
    pub(super) fn add(&mut self, line: &Value) {
        self.num_frames += 1;
        self.num_clean_frames_before += usize::from(is(line, "clean_before"));
        self.num_clean_frames += usize::from(is(line, "clean"));
        self.num_zeroed_coordinates += number(&line["num_zeroed_coordinates"]);
        self.num_unchanged_frames += usize::from(number(&line["num_moved_vertices"]) == 0);
    }

    /// Ends the counting.
    pub(super) fn finish(&mut self, smoothness: Roughness) {
        self.smoothness = smoothness;
        self.num_unchanged_vertices = self.num_vertices - smoothness.num_vertices;
        self.clean = self.num_clean_frames == self.num_frames;
    }

    pub(super) fn words(&self) -> String {
        let Self { num_frames, num_clean_frames_before, num_clean_frames, num_unchanged_frames, .. } = self;
        let unchanged = Counted(self.num_unchanged_vertices, "vertex");
        let zeroed = words::zeroed_line(self.num_zeroed_coordinates);
        format!(
            "{zeroed}  {num_clean_frames} of {num_frames} frames are clean, {num_clean_frames_before} were\n  \
             {num_unchanged_frames} frames and {unchanged} are unchanged to the bit\n{}",
            self.smoothness_words(),
        )
    }

    /// The line for the smoothness; nothing where nothing was corrected.
    fn smoothness_words(&self) -> String {
        let Roughness { num_vertices, max_second_difference_m, p99_ratio_to_smooth, .. } = self.smoothness;
        match (num_vertices, max_second_difference_m, p99_ratio_to_smooth) {
            (0, ..) => String::new(),
            (_, Some(difference_m), Some(ratio)) => format!(
                "  corrections change by up to {:.3} mm a frame squared, of 99 in 100 vertices by at most {ratio:.2} \
                 times what a smooth bump as high needs\n",
                1000.0 * difference_m,
            ),
            _ => "  how smoothly corrections change is not measured: that needs three frames\n".to_owned(),
        }
    }
}
