//! `--gap` and `--gap-for`: the distance that primitives keep from each other, for solvers that refuse states that are
//! too close.
//!
//! | file | purpose |
//! |---|---|
//! | `presets` | the rules of other tools, which `--gap-for` takes |
//! | `args` | the arguments |
//! | `judge` | pairs below it in a written file, by the judge |
//! | `side` | a primitive by file, object and vertices |
//! | `places` | where pairs could not be set apart |
//! | `report` | what there is below the distance, as JSON and as a line for people |

mod args;
mod judge;
mod places;
mod presets;
mod report;
mod side;

pub use args::{Asked, GapArgs};
pub use judge::GapCertificate;
pub use places::InfeasibleReport;
pub use presets::{Preset, Tool};
pub use report::{GapError, GapReport, NearestPair};
pub use side::Side;
