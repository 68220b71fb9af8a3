//! Untangling on another machine: carries live sessions between hosts here and daemons elsewhere, over Zenoh.
//!
//! ```text
//! host  <- shared memory ->  untangled-bridge host  <- Zenoh ->  untangled-bridge daemon  <- shared memory ->  daemon
//! ```
//!
//! Near the host the bridge looks like a daemon ([`host`]), near the daemon like a client ([`daemon`]): neither knows
//! of it. Requests are queries; states and corrections are published. Both ends pass on what they have checked for
//! length, and not for meaning.
//!
//! Modules, each using only those before it: `error`; [`wire`] (what crosses the network); [`metrics`]; [`net`]
//! (Zenoh, certificates, windows); `options`, `housekeeping`; [`host`], [`daemon`]; [`config`]; [`cli`].

pub mod cli;
pub mod config;
pub mod daemon;
pub mod error;
pub mod host;
mod housekeeping;
pub mod metrics;
pub mod net;
pub mod options;

pub use untangled_bridge_wire as wire;
