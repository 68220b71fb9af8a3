//! The progress of a sequence, with the time left.

use std::{
    sync::atomic::{AtomicU64, Ordering},
    time::{Duration, Instant},
};

use crate::cli::progress_line::ProgressLine;

/// What is done with the frames of a sequence, in the line of the command.
#[derive(Debug)]
pub(super) struct FrameProgress {
    line: ProgressLine,
    start: Instant,
    num_done: AtomicU64,
    num_frames: u64,
    num_passes: usize,
}

impl FrameProgress {
    pub(super) fn new(num_frames: u64, num_passes: usize) -> Self {
        let (start, num_done) = (Instant::now(), AtomicU64::new(0));
        Self { line: ProgressLine::new(), start, num_done, num_frames, num_passes }
    }

    /// Shows that a pass over a frame begins. Some seconds may go by before the first frame is done: many frames go
    /// through the first passes before.
    pub(super) fn begin(&self, pass: usize, frame: u64) {
        let num_done = self.num_done.load(Ordering::Relaxed);
        let pass =
            if self.num_passes > 1 { format!(", pass {} of {}", pass + 1, self.num_passes) } else { String::new() };
        self.line.set(format!("frame {frame}{pass}; {}", self.words(num_done)));
    }

    /// Shows that a frame is done.
    pub(super) fn done(&self, frame: u64) {
        let num_done = self.num_done.fetch_add(1, Ordering::Relaxed) + 1;
        self.line.set(format!("frame {frame} is done; {}", self.words(num_done)));
    }

    fn words(&self, num_done: u64) -> String {
        let left = if num_done == 0 { String::new() } else { format!(", {} left", words(self.time_left(num_done))) };
        format!("{num_done} of {} frames are done{left}", self.num_frames)
    }

    /// Frames take as long as those before them, on the mean.
    fn time_left(&self, num_done: u64) -> Duration {
        let left = self.num_frames.saturating_sub(num_done);
        let [left, done] = [left, num_done.max(1)].map(|count| u32::try_from(count).unwrap_or(u32::MAX));
        (self.start.elapsed() / done).saturating_mul(left)
    }
}

fn words(time: Duration) -> String {
    match time.as_secs() {
        seconds @ 0..120 => format!("{seconds} s"),
        seconds @ 120..7200 => format!("{} min", seconds.div_ceil(60)),
        seconds => format!("{} h {} min", seconds / 3600, seconds % 3600 / 60),
    }
}
