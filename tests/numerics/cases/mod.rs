//! Input at the limits: for each extreme what is promised, and a measurement that says what was seen and whether the promise held.
//!
//! `examples/numerics.rs` makes a document of all of it, `tests/numerics` fails where a promise is broken. What other tests hold already
//! is not repeated here; the document names them.

mod answer;
mod contact;
mod fits;
mod laws;
mod numbers;
mod place;
mod refusals;
mod shape;
pub(crate) mod single;
mod time;

use std::panic::{AssertUnwindSafe, catch_unwind};

/// How much of it is tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Effort {
    /// What a test has time for.
    Quick,
    /// What the document says.
    Full,
}

impl Effort {
    /// One number for a test, another for the document.
    fn choose<T>(self, quick: T, full: T) -> T {
        if self == Self::Quick { quick } else { full }
    }
}

/// What was seen, or in what way a promise was broken.
pub(crate) type Seen = Result<String, String>;

/// One extreme.
pub(crate) struct Case {
    /// What is done.
    pub(crate) what: String,
    /// What is promised for it.
    pub(crate) promise: &'static str,
    measure: Box<dyn Fn(Effort) -> Seen>,
}

impl Case {
    fn new(what: impl Into<String>, promise: &'static str, measure: impl Fn(Effort) -> Seen + 'static) -> Self {
        Self { what: what.into(), promise, measure: Box::new(measure) }
    }

    /// Measures; a panic is a broken promise like any other.
    pub(crate) fn measure(&self, effort: Effort) -> Seen {
        catch_unwind(AssertUnwindSafe(|| (self.measure)(effort))).unwrap_or_else(|panic| {
            let words = panic.downcast_ref::<String>().cloned();
            Err(words.or_else(|| panic.downcast_ref::<&str>().map(|&words| words.into())).unwrap_or_default())
        })
    }
}

/// Extremes of one kind.
pub(crate) struct Chapter {
    pub(crate) title: &'static str,
    pub(crate) text: &'static str,
    pub(crate) cases: Vec<Case>,
}

/// All there are.
pub(crate) fn chapters() -> Vec<Chapter> {
    vec![
        place::chapter(),
        shape::chapter(),
        contact::chapter(),
        fits::chapter(),
        laws::chapter(),
        numbers::chapter(),
        refusals::chapter(),
    ]
}

/// A promise that must hold for the measurement to go on.
fn ensure(holds: bool, words: impl FnOnce() -> String) -> Result<(), String> {
    if holds { Ok(()) } else { Err(words()) }
}
