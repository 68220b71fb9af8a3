//! Input at the limits: for each extreme what is promised, and a measurement that says what was seen and whether the
//! promise held.
//!
//! The laboratory's `numerics` makes `docs/results/numerics.md` of all of it; a test of the same name fails where a
//! promise is broken. What other tests hold already is not repeated here; the document names them.

mod answer;
mod case;
mod chapters;
pub mod single;

pub use case::{Case, Chapter, Effort, Seen};
pub use chapters::chapters;
