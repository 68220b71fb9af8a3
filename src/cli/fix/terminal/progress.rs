//! The progress line of a relaxation.

use std::{
    io::{self, Write},
    time::{Duration, Instant},
};

use indicatif::{ProgressBar, ProgressStyle};

use untangle::relax::Iteration;

use crate::cli::wording::name_of;

/// One line on standard error, if that is a terminal, which is cleared at the end; else a line every few seconds.
#[derive(Debug)]
pub(crate) struct Progress {
    bar: ProgressBar,
    num_iterations: usize,
    last_line: Instant,
    is_silent: bool,
}

/// Time between two lines where standard error is no terminal.
const BETWEEN_LINES: Duration = Duration::from_secs(5);

impl Progress {
    pub(crate) fn new() -> Self {
        // indicatif hides the line where standard error is not a terminal.
        let bar = ProgressBar::new_spinner();
        if let Ok(style) = ProgressStyle::with_template("{spinner} {elapsed} {msg}") {
            bar.set_style(style);
        }
        bar.enable_steady_tick(Duration::from_millis(100));
        Self { bar, num_iterations: 0, last_line: Instant::now(), is_silent: false }
    }

    /// Of one of several repairs side by side, which share a line of their own.
    pub(crate) fn silent() -> Self {
        Self { bar: ProgressBar::hidden(), num_iterations: 0, last_line: Instant::now(), is_silent: true }
    }

    /// Shows the current stage.
    pub(crate) fn say(&self, what: &'static str) {
        self.bar.set_message(what);
    }

    /// Shows the state after an iteration.
    pub(crate) fn iteration(&mut self, iteration: &Iteration) {
        self.num_iterations += 1;
        let Iteration { num_edge_face_intersections, path_length_m, method, num_pairs_below } = iteration;
        // The sum of no lengths is a negative zero.
        let path_length_m = path_length_m + 0.0;
        let state = num_pairs_below.map_or_else(
            || format!("{num_edge_face_intersections} edge-face intersections, paths of {path_length_m:.4} m"),
            |count| format!("{count} primitive pairs too close"),
        );
        let line = format!("iteration {}: {state} ({})", self.num_iterations, name_of(method));
        if self.bar.is_hidden() && !self.is_silent && self.last_line.elapsed() >= BETWEEN_LINES {
            self.last_line = Instant::now();
            // Nobody may be there to read it.
            let _ = writeln!(io::stderr(), "untangled: {line}");
        }
        self.bar.set_message(line);
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
