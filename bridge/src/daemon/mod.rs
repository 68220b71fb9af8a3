//! The end of a bridge near a daemon: a client of it, on behalf of hosts elsewhere.
//!
//! | file | what |
//! |---|---|
//! | `local` | the daemon of the local domain |
//! | `hosts` | the host ends that are served, and what each may take |
//! | `requests` | requests of hosts |
//! | `shared`, `run` | what the threads share, and the run loop |
//! | `link`, `ports` | one session: a client's ports, and the way to the host end |

mod hosts;
mod link;
mod local;
mod ports;
mod requests;
mod run;
mod shared;

pub use run::run;
