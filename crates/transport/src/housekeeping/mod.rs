//! Housekeeping: removes the resources of crashed peers, for whoever serves a domain.
//!
//! | file | what it does |
//! |---|---|
//! | `changes` | change detection: whether there can be anything to clean up |
//! | `dead_nodes` | lets iceoryx2 clean up its dead nodes, from a run loop |
//! | `stale` | finds and removes stale resources that no node names |
//! | `cleanup` | the thread that removes stale resources and unfinished segments |

mod changes;
mod cleanup;
mod dead_nodes;
mod stale;

pub use cleanup::{Cleanup, Finding};
pub use dead_nodes::DeadNodes;
