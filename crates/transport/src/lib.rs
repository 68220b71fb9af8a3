//! How the daemon and its clients meet: domains, the lock of a domain, the iceoryx2 services, and their shared memory.
//!
//! What crosses them is plain data, in `untangled_proto`.

pub mod domain;
pub mod lock;
pub mod memory;
pub mod services;

pub use domain::{Domain, DomainError};
