//! What a host links to talk to the untangled daemon.
//!
//! ```no_run
//! use std::time::Duration;
//! use untangled_client::{Client, ClientOptions, Registration, StepTime, flags};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let client = Client::connect(ClientOptions::default())?;
//! let mut session = client.register(Registration {
//!     num_vertices: 3,
//!     triangles: vec![[0, 1, 2]],
//!     ..Registration::default()
//! })?;
//! let mut cloth = vec![[0.0f32; 3]; 3];
//! let step = StepTime { simulated_s: 0.0, dt_s: 1.0 / 60.0 };
//! let correction = session.exchange(step, Duration::from_millis(50), |positions| positions.copy_from_slice(&cloth))?;
//! for (position, vertex) in cloth.iter_mut().zip(correction.vertices()) {
//!     for (x, dx) in position.iter_mut().zip(vertex.value) {
//!         *x += dx; // the default kind of correction is a displacement in metres
//!     }
//!     let _self_collision_off_here = vertex.flags & flags::MASK != 0;
//! }
//! # Ok(())
//! # }
//! ```
//!
//! This crate installs no signal handlers, starts no threads, and does not block beyond a deadline that the caller
//! gave. It notices a daemon that died or was restarted, and registers the session again at its next call: see
//! [`Session`].
//!
//! Modules, each using only those before it: `error`, `memory`, `poll`; `connection` (node and control services),
//! `request` (one request and its reply), `registration`; `paths`, `link` (ports of a session), `reconnect` (registers
//! again), `loan`, `correction`; `session`; `client`.

mod client;
mod connection;
mod correction;
mod error;
mod link;
mod loan;
mod memory;
mod paths;
mod poll;
mod reconnect;
mod registration;
mod request;
mod session;

pub use client::{Client, ClientOptions};
pub use correction::Correction;
pub use error::{
    ConnectError, ExchangeError, FrameRefusal, NewestError, PublishError, RegisterError, RequestError, WaitError,
};
pub use loan::{Loan, LoanMemory, StepTime};
pub use paths::Paths;
pub use registration::{Registration, Uvs};
pub use session::Session;
pub use untangled_proto::{
    CorrectionHeader, CorrectionKind, Precision, Status, VertexCorrection, flags, pair_type,
    paths::{PathPoint, PathRecord, path_type},
};

/// Compiles the first client of the README.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;
