//! Housekeeping: removes the resources of crashed peers and makes room for those of this process.
//!
//! | file | what it does |
//! |---|---|
//! | `changes` | change detection: whether there can be anything to clean up |
//! | `dead_nodes` | lets iceoryx2 clean up its dead nodes, from the run loop |
//! | `stale` | finds and removes stale resources that no node names |
//! | `cleanup` | the thread that removes stale resources and unfinished segments |
//! | `descriptors` | raises the limit of open files to what the sessions need |

mod changes;
mod cleanup;
mod dead_nodes;
mod descriptors;
mod stale;

pub(crate) use cleanup::Cleanup;
pub(crate) use dead_nodes::DeadNodes;
pub(crate) use descriptors::make_room_for_descriptors;
