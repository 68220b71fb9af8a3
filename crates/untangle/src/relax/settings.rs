//! What a caller of the relaxation chooses.

use serde::{Deserialize, Serialize};

use crate::stage::{Stage, StageObserver};

/// Time against result: how many trial displacements an iteration makes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Effort {
    /// One stiffness, until progress stalls, and one attempt.
    Fast,
    /// Three stiffnesses.
    #[default]
    Balanced,
    /// As [`Effort::Balanced`], and where progress stalls twice as many trials with the other objectives.
    Accurate,
}

/// The caller's function that says whether the work is to end, asked from several threads.
pub(super) type ShouldStop<'s> = dyn Fn() -> bool + Sync + 's;

/// Ends an analysis or a search that is to stop: what it leaves out is not used.
pub(super) struct StopObserver<'s>(pub(super) &'s (dyn Fn() -> bool + 's));

impl StageObserver for StopObserver<'_> {
    fn begin(&mut self, _: Stage) {}
    fn end(&mut self) {}
    fn is_spent(&mut self) -> bool {
        (self.0)()
    }
}

/// What a caller chooses.
#[derive(Clone, Debug, PartialEq)]
pub struct RelaxSettings {
    /// Time against result.
    pub effort: Effort,
    /// Gives up after this many iterations: each attempt, where there are several.
    pub max_iterations: usize,
    /// Whether positions are rounded to single precision in each state, for files that hold no more.
    pub single_precision: bool,
    /// Whether other attempts are made where the first one goes a long way, and the least of all ends is kept: several
    /// times as long there. And whether the result hangs on the shape alone, not on names and last bits. For who does
    /// not wait for the result, of an input that does not follow from another.
    pub other_attempts: bool,
}

impl Default for RelaxSettings {
    fn default() -> Self {
        Self { effort: Effort::default(), max_iterations: 100, single_precision: false, other_attempts: true }
    }
}
