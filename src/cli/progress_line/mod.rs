//! What is being done, on standard error: one line that changes, if that is a terminal; else a line now and then.

mod beat;

use std::{io, time::Duration};

use indicatif::{ProgressBar, ProgressStyle};

use beat::Beat;

/// Time between two lines where standard error is no terminal.
const BETWEEN_LINES: Duration = Duration::from_secs(10);

/// The line of a command, which is cleared at the end.
#[derive(Debug)]
pub(super) struct ProgressLine {
    bar: ProgressBar,
    beat: Option<Beat>,
}

impl ProgressLine {
    pub(super) fn new() -> Self {
        // indicatif hides the line where standard error is not a terminal.
        let bar = ProgressBar::new_spinner();
        if let Ok(style) = ProgressStyle::with_template("{spinner} {elapsed} {msg}") {
            bar.set_style(style);
        }
        bar.enable_steady_tick(Duration::from_millis(100));
        let beat = bar.is_hidden().then(|| Beat::start(BETWEEN_LINES, io::stderr()));
        Self { bar, beat }
    }

    /// A line that nobody sees.
    pub(super) fn hidden() -> Self {
        Self { bar: ProgressBar::hidden(), beat: None }
    }

    /// Shows what is being done.
    pub(super) fn set(&self, what: String) {
        match &self.beat {
            Some(beat) => beat.set(what),
            None => self.bar.set_message(what),
        }
    }
}

impl Drop for ProgressLine {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
