//! An extreme with its promise.

use std::{
    fmt,
    panic::{AssertUnwindSafe, catch_unwind},
};

/// How much of it is tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// What a test has time for.
    Quick,
    /// What the document says.
    Full,
}

impl Effort {
    /// One number for a test, another for the document.
    pub(super) fn choose<T>(self, quick: T, full: T) -> T {
        if self == Self::Quick { quick } else { full }
    }
}

/// What was seen, or in what way a promise was broken.
pub type Seen = Result<String, String>;

/// One extreme.
pub struct Case {
    /// What is done.
    pub what: String,
    /// What is promised for it.
    pub promise: &'static str,
    measure: Box<dyn Fn(Effort) -> Seen>,
}

impl fmt::Debug for Case {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_struct("Case").field("what", &self.what).field("promise", &self.promise).finish_non_exhaustive()
    }
}

impl Case {
    pub(super) fn new(
        what: impl Into<String>,
        promise: &'static str,
        measure: impl Fn(Effort) -> Seen + 'static,
    ) -> Self {
        Self { what: what.into(), promise, measure: Box::new(measure) }
    }

    /// Measures; a panic is a broken promise too.
    ///
    /// # Errors
    /// In what way the promise is broken.
    pub fn measure(&self, effort: Effort) -> Seen {
        catch_unwind(AssertUnwindSafe(|| (self.measure)(effort))).unwrap_or_else(|panic| {
            let words = panic.downcast_ref::<String>().cloned();
            Err(words.or_else(|| panic.downcast_ref::<&str>().map(|&words| words.into())).unwrap_or_default())
        })
    }
}

/// Extremes of one kind.
#[derive(Debug)]
pub struct Chapter {
    /// Its heading.
    pub title: &'static str,
    /// What is common to its cases.
    pub text: &'static str,
    /// Its cases.
    pub cases: Vec<Case>,
}

/// A promise that must hold for the measurement to go on.
pub(super) fn ensure(holds: bool, words: impl FnOnce() -> String) -> Result<(), String> {
    if holds { Ok(()) } else { Err(words()) }
}
