//! One step of the cloth: a displacement that satisfies constraints, shortened by strain limits and a line search.
//!
//! | file | purpose |
//! |---|---|
//! | `displacement` | the least change of shape that satisfies constraints |
//! | `islands` | islands of coupled contours: what is judged and chosen together |
//! | `tangle` | how tangled each island is |
//! | `damping` | displacements held back round some vertices |
//! | `trial` | one trial displacement: contacts, strain limits, line search |
//! | `selection` | the best of several trials, island by island |
//! | `collision_free` | steps that must not intersect anything |
//! | `precision` | positions rounded to what a file holds |

mod collision_free;
mod damping;
mod displacement;
mod islands;
mod precision;
mod selection;
mod tangle;
mod trial;

pub(crate) use collision_free::CollisionFreeStep;
pub(crate) use damping::{Backtracking, Damping};
pub(crate) use displacement::{DisplacementSolver, SolverBudget, Start};
pub(crate) use islands::Islands;
pub(crate) use precision::stored;
pub(crate) use selection::{least_strained, least_tangled};
pub(crate) use tangle::{Tangle, measure, total};
pub(crate) use trial::{Trial, TrialContext, TrialSettings, island_strains};
