//! The progress of a relaxation.

use untangle::relax::{Iteration, Method};

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
        self.line.set(words(self.num_iterations, iteration));
    }
}

/// The state after an iteration. Shape recovery is the last that is told of a clean state: other attempts, which follow
/// where that is far from the input and take longer, tell nothing.
fn words(number: usize, iteration: &Iteration) -> String {
    let Iteration { num_edge_face_intersections, path_length_m, method, num_pairs_below } = iteration;
    let state = match num_pairs_below {
        Some(count) => format!("{count} primitive pairs too close"),
        None if *num_edge_face_intersections == 0 && *method == Method::RecoverShape => {
            "nothing intersects; looking for a state nearer to the input".to_owned()
        }
        // The sum of no lengths is a negative zero.
        None => format!("{num_edge_face_intersections} edge-face intersections, paths of {:.4} m", path_length_m + 0.0),
    };
    format!("iteration {number}: {state} ({})", name_of(method))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clean_state_is_said_to_be_made_nearer_and_a_tangled_one_to_have_what_it_has() {
        let after = |num_edge_face_intersections, method| Iteration {
            num_edge_face_intersections,
            path_length_m: -0.0,
            method,
            num_pairs_below: None,
        };
        let nearer = "iteration 12: nothing intersects; looking for a state nearer to the input (settle)";
        assert_eq!(words(12, &after(0, Method::RecoverShape)), nearer);
        let blocked = "iteration 3: 2 edge-face intersections, paths of 0.0000 m (settle)";
        assert_eq!(words(3, &after(2, Method::RecoverShape)), blocked);
        // Cloth may be on the wrong side still.
        assert_eq!(
            words(1, &after(0, Method::Push)),
            "iteration 1: 0 edge-face intersections, paths of 0.0000 m (push)"
        );
        let close = Iteration { num_pairs_below: Some(4), ..after(0, Method::Gap) };
        assert_eq!(words(9, &close), "iteration 9: 4 primitive pairs too close (gap)");
    }
}
