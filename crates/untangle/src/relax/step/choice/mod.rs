//! Which trial each island takes.
//!
//! | file | purpose |
//! |---|---|
//! | `groups` | islands that must take the same trial, since different ones would tear the cloth between them |
//! | `selection` | the best of several trials, for one group |

mod groups;
mod selection;

pub(crate) use groups::{Groups, Seams};
pub(crate) use selection::{choose_together, least_tangled};
