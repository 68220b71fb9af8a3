//! The progress of a relaxation.

use untangle::relax::Iteration;

use crate::cli::{progress_line::ProgressLine, wording::name_of};

/// What a repair is doing, in the line of the command.
#[derive(Debug)]
pub(crate) struct Progress {
    line: ProgressLine,
    num_iterations: usize,
}

impl Progress {
    pub(crate) fn new() -> Self {
        Self { line: ProgressLine::new(), num_iterations: 0 }
    }

    /// Of one of several repairs side by side, which share a line of their own.
    pub(crate) fn silent() -> Self {
        Self { line: ProgressLine::hidden(), num_iterations: 0 }
    }

    /// Shows the current stage.
    pub(crate) fn say(&self, what: &'static str) {
        self.line.set(what.to_owned());
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
        self.line.set(format!("iteration {}: {state} ({})", self.num_iterations, name_of(method)));
    }
}
