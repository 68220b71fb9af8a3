//! What a terminal shows while the relaxation runs.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

use crate::cli::input::name_of;
use untangle::relax::Iteration;

/// One line on standard error, if that is a terminal, which goes away in the end.
#[derive(Debug)]
pub(super) struct Progress {
    bar: ProgressBar,
    num_iterations: usize,
}

impl Progress {
    pub(super) fn new() -> Self {
        // Hidden where standard error is no terminal.
        let bar = ProgressBar::new_spinner();
        if let Ok(style) = ProgressStyle::with_template("{spinner} {elapsed} {msg}") {
            bar.set_style(style);
        }
        bar.enable_steady_tick(Duration::from_millis(100));
        Self { bar, num_iterations: 0 }
    }

    /// Says what is done now.
    pub(super) fn say(&self, what: &'static str) {
        self.bar.set_message(what);
    }

    /// Says how far the relaxation has come.
    pub(super) fn iteration(&mut self, iteration: &Iteration) {
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
