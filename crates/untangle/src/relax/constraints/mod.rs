//! What a displacement has to satisfy: linear inequalities from the paths, and limits on strain.
//!
//! | file | purpose |
//! |---|---|
//! | `rows` | the inequalities, row by row |
//! | `from_paths` | the rows of each path, for one of three objectives |
//! | `local` | the same rows in the numbers of a domain, for inner loops |
//! | `shape_limits` | how far edges and faces may get from their shape |
//! | `strain_limits` | steps that would crush or overstretch the cloth (Provot 1995) |

mod from_paths;
mod local;
mod rows;
mod shape_limits;
mod strain_limits;

pub(crate) use from_paths::{ConstraintSource, Objective, collect, collect_undecided};
pub(crate) use local::{LocalConstraints, row_value};
pub(crate) use rows::Constraints;
pub(in crate::relax) use shape_limits::ShapeLimits;
pub use strain_limits::STRETCH_LIMIT;
pub(crate) use strain_limits::StrainLimits;
