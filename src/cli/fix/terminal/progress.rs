//! The progress line of a relaxation.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

use untangle::relax::Iteration;

use crate::cli::wording::name_of;

/// One line on standard error, if that is a terminal; it is cleared at the end.
#[derive(Debug)]
pub(crate) struct Progress {
    bar: ProgressBar,
    num_iterations: usize,
}

impl Progress {
    pub(crate) fn new() -> Self {
        // indicatif hides the line where standard error is not a terminal.
        let bar = ProgressBar::new_spinner();
        if let Ok(style) = ProgressStyle::with_template("{spinner} {elapsed} {msg}") {
            bar.set_style(style);
        }
        bar.enable_steady_tick(Duration::from_millis(100));
        Self { bar, num_iterations: 0 }
    }

    /// Shows the current stage.
    pub(crate) fn say(&self, what: &'static str) {
        self.bar.set_message(what);
    }

    /// Shows the state after an iteration.
    pub(crate) fn iteration(&mut self, iteration: &Iteration) {
        self.num_iterations += 1;
        let Iteration { num_edge_face_intersections, path_length_m, method } = iteration;
        self.bar.set_message(format!(
            "iteration {}: {num_edge_face_intersections} edge-face intersections, paths of {path_length_m:.4} m ({})",
            self.num_iterations,
            name_of(method),
        ));
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
