//! How the daemon and its clients meet: domains, the lock of a domain, the iceoryx2 services, and their shared memory.
//!
//! The data that crosses them is defined in `untangled_proto`.
//!
//! | module | what it does |
//! |---|---|
//! | [`domain`] | names, root folder and prefix of a private corner of iceoryx2; who may use it |
//! | [`folders`] | folders that no other user can have put there |
//! | [`search`] | where else a daemon of this user serves |
//! | [`lock`] | one daemon at a time in a domain; wipes a domain that no process uses |
//! | [`services`] | creates and opens the iceoryx2 services; those of who watches a session in `views` |
//! | [`memory`] | free space, committed pages, unfinished segments |
//! | [`housekeeping`] | removes the resources of crashed peers |
//! | [`throttle`] | a rate limit for log lines that a peer can cause |
//! | [`clock`] | the clock that all processes share |
//! | [`process_id`] | process ids in the names of files, to find resources of crashed peers; names of processes |

pub mod clock;
pub mod domain;
pub mod folders;
pub mod housekeeping;
pub mod lock;
pub mod memory;
pub mod node;
pub mod process_id;
pub mod search;
pub mod services;
pub mod throttle;

pub use domain::{Domain, DomainError};
