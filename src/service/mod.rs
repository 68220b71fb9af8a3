//! The daemon: sessions of hosts, requests, housekeeping.
//!
//! ```text
//! event ──> daemon ─┬─> requests ──> pool: register ──> session (mesh, settings, ports)
//!                   └─> sessions ──> pool: ingest ──> Untangler ──> publish ──> event to the host
//!                                     └─> pool of repairs: relax ──> check ──> publish ──> event to the host
//! timer ──> housekeeping: dead nodes; a thread of its own for stale resources
//! ```
//!
//! One thread waits for events and distributes work; workers do it, each session's work one worker at a time. A frame
//! that takes no longer than waking a worker the waiting thread does itself, one after each wait. Between events all
//! threads sleep. Everything that a peer wrote is copied before it is checked, because the peer may go on
//! writing.
//!
//! The folders, from the bottom up: `repair` (one frame moved to where nothing intersects), [`session`] (one cloth and
//! its frames), [`requests`] (what clients ask for, and the sessions that are open), `descriptors` (a limit of this
//! process). `daemon` is on top. Housekeeping, which removes the resources of crashed peers, is
//! [`untangled_transport::housekeeping`].

mod daemon;
mod descriptors;
mod error;
mod metrics;
mod options;
mod pool;
mod port_options;
mod repair;
pub mod requests;
pub mod session;

pub use daemon::{Shutdown, run};
pub use error::{Refusal, ServeError};
pub use options::{DEFAULT_REPAIR_WORKERS, ServeOptions};
