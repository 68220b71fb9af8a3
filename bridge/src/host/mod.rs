//! The end of a bridge near a host: a daemon in the local domain, as far as hosts can see.
//!
//! | file | what |
//! |---|---|
//! | `front` | the place in the local domain: the services that clients look for |
//! | `requests` | the way of a request to a daemon, and of its reply |
//! | `directory` | the daemon ends that are there, and the choice among them |
//! | `listen` | what it hears from the network |
//! | `session`, `sessions`, `ports` | a session: its ports, and its link |
//! | `status` | what this end says of itself |
//! | `shared`, `run` | what the threads share, and the run loop |
//! | `refusal` | a request that is refused here |
//!
//! While no daemon serves anywhere, there is no server for requests in the domain, which is what a client finds
//! between two runs of a local daemon.

mod directory;
mod front;
mod listen;
mod ports;
mod refusal;
mod requests;
mod run;
mod session;
mod sessions;
mod shared;
mod status;

pub use run::run;
