//! One step of the cloth: a displacement that satisfies constraints, shortened by strain limits and a line search.
//!
//! | file | purpose |
//! |---|---|
//! | `displacement` | the least change of shape that satisfies constraints |
//! | `islands` | islands of coupled contours: what is judged and chosen together |
//! | `passing` | where the sheets are to pass through each other |
//! | `pinned` | intersections that no motion changes |
//! | `tangle` | how tangled each island is |
//! | `damping` | displacements held back round some vertices |
//! | `trial` | one trial displacement: contacts, strain limits, line search |
//! | `choice` | which trial each island takes |
//! | `collision_free` | steps that must not intersect anything |
//! | `precision` | positions rounded to what a file holds |

mod choice;
mod collision_free;
mod damping;
mod displacement;
mod islands;
mod passing;
mod pinned;
mod precision;
mod tangle;
mod trial;

pub(crate) use choice::{Seams, choose_together, least_tangled};
pub(crate) use collision_free::CollisionFreeStep;
pub(crate) use damping::{Backtracking, Damping};
pub(crate) use displacement::{DisplacementSolver, SolverBudget, Start};
pub(crate) use islands::Islands;
pub(crate) use passing::mark_passing;
pub(crate) use pinned::{are_faces_pinned, is_movable, num_movable, remove_pinned_chains};
pub(crate) use precision::{Precision, sent, stored};
pub(crate) use tangle::{Tangle, measure, measure_touched, total};
pub(crate) use trial::{Trial, TrialContext, TrialSettings, island_strains};
