//! Roles beside cloth: bodies that stay where they are.
//!
//! | file | purpose |
//! |---|---|
//! | `bodies` | `--body`: reading them, and putting cloth and bodies into one world |
//! | `counts` | what cloth and bodies have with each other |

mod bodies;
mod counts;

pub(super) use bodies::Bodies;
pub use bodies::{BodyReport, RoleArgs};
pub use counts::BodyCounts;
pub(super) use counts::say_bodies;
