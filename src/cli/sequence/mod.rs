//! `check` and `fix` of sequences: the FILEs give the mesh, a vertex cache its positions frame by frame.
//!
//! Each module uses those above it in this table only.
//!
//! | module | purpose |
//! |---|---|
//! | `args`, `error` | the arguments; why a sequence was not finished |
//! | `pipeline` | work on frames, on all processors, in stages, taken in order |
//! | `words` | what is said of a frame to people |
//! | `progress` | the line with the time left |
//! | `shot` | cloth and bodies at one instant, as `check` and `fix` see files |
//! | `page` | `--html`: a page with all frames |
//! | `check` | `check --cache` |
//! | `fix` | `fix --cache`: passes over the frames, output, journal |

pub mod args;
mod check;
mod error;
mod fix;
mod page;
mod pipeline;
mod progress;
mod shot;
mod words;

pub use check::check;
pub use error::SequenceError;
pub use fix::fix;

/// Name and version of the lines that are printed.
const SCHEMA: &str = "untangled.sequence/1";
