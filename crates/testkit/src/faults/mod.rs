//! Rows of the fault table: what is killed, filled up or lied to, and what the others lose by it.

mod end;
mod full_memory;
mod hostile;
mod kills;
mod limit_cases;
mod limits;
mod row;
mod sessions;
mod witness;

pub use full_memory::{full_memory, full_memory_main};
pub use hostile::{lying_headers, lying_repair_requests, writing_after_sending};
pub use kills::{all_killed, client_kills, daemon_kills, observer_faults, stopped_clients};
pub use limits::request_limits;
pub use row::Row;
pub use sessions::{many_sessions, open_and_close};
