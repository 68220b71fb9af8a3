//! The progress line of a sequence, with the time left.

use std::{
    io::{self, Write},
    time::{Duration, Instant},
};

use indicatif::{ProgressBar, ProgressStyle};

/// Time between two lines where standard error is no terminal.
const BETWEEN_LINES: Duration = Duration::from_secs(5);

/// One line on standard error, if that is a terminal, which is cleared at the end; else a line every few seconds.
#[derive(Debug)]
pub(super) struct FrameProgress {
    bar: ProgressBar,
    start: Instant,
    last_line: Instant,
    num_done: u64,
    num_frames: u64,
}

impl FrameProgress {
    pub(super) fn new(num_frames: u64) -> Self {
        // indicatif hides the line where standard error is not a terminal.
        let bar = ProgressBar::new_spinner();
        if let Ok(style) = ProgressStyle::with_template("{spinner} {elapsed} {msg}") {
            bar.set_style(style);
        }
        bar.enable_steady_tick(Duration::from_millis(100));
        let now = Instant::now();
        Self { bar, start: now, last_line: now, num_done: 0, num_frames }
    }

    /// Shows that a frame is done.
    pub(super) fn done(&mut self, frame: u64) {
        self.num_done += 1;
        let line = format!("frame {frame}, {} of {}, {} left", self.num_done, self.num_frames, words(self.time_left()));
        if self.bar.is_hidden() && self.last_line.elapsed() >= BETWEEN_LINES {
            self.last_line = Instant::now();
            // Nobody may be there to read it.
            let _ = writeln!(io::stderr(), "untangled: {line}");
        }
        self.bar.set_message(line);
    }

    /// Frames take as long as those before them, on the mean.
    fn time_left(&self) -> Duration {
        let left = self.num_frames.saturating_sub(self.num_done);
        let [left, done] = [left, self.num_done.max(1)].map(|count| u32::try_from(count).unwrap_or(u32::MAX));
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

impl Drop for FrameProgress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
