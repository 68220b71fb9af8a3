//! Requests of clients, and the sessions that they open. Each request gets one reply, a refusal included.
//!
//! | file | what it does |
//! |---|---|
//! | `control` | receives requests; those about a mesh are handed to workers |
//! | `reply` | answers a request and sends the reply |
//! | `registration` | reads and validates a registration |
//! | `registry` | the open sessions |
//! | `audience` | how many may watch them |
//! | `status` | the report of the daemon |

mod audience;
mod control;
pub mod registration;
mod registry;
mod reply;
pub(crate) mod status;

pub(crate) use control::{ControlServer, MeshRequest};
pub(crate) use registry::Registry;
