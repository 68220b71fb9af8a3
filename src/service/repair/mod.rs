//! Repairs: from the positions of one frame to the displacement of every vertex to a state without intersections, which
//! an exact check finds clean at the very bits that the host has after adding it.
//!
//! ```text
//! session: frame that asks ──> desk: newest request ──> pool: solve, check ──> port ──> event to the host
//! ```
//!
//! Repairs have threads of their own, of a lower priority than those of frames, so that a long one delays no frame. A
//! session has one repair in work at a time, which ends when the session does, and one request that waits: the newest.
//!
//! | file | purpose |
//! |---|---|
//! | `displacement` | what is added, in the precision of the host, and where that leads |
//! | `distortion` | how much the cloth changes |
//! | `judge` | the check of a state, by code that the library has no part in |
//! | `solve` | rounds of relaxation and check |
//! | `port` | the publisher of a session |
//! | `progress` | when the daemon asks by itself |
//! | `desk` | the requests of a session, and their answers |
//! | `workers` | the threads of all sessions |
//!
//! A row uses those above it only.

mod desk;
mod displacement;
mod distortion;
mod judge;
mod port;
mod progress;
mod requests;
mod solve;
mod workers;

pub(crate) use desk::RepairDesk;
pub(crate) use port::RepairPort;
pub(crate) use requests::Counts;
pub(crate) use workers::RepairWorkers;
