//! Roles of files: bodies that stay where they are, and layers in order.
//!
//! | file | purpose |
//! |---|---|
//! | `files` | `--body`, `--layers`: reading bodies, and putting cloth and bodies into one world |
//! | `counts` | what cloth and bodies have with each other, and what is behind an inner layer |

mod counts;
mod files;

pub use counts::{BodyCounts, LayerReport};
pub(super) use counts::{num_behind, say_bodies, say_layers};
pub(super) use files::Roles;
pub use files::{BodyReport, RoleArgs};
