//! What a host links to talk to the untangled daemon.
//!
//! ```no_run
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
//! let deadline = session.default_deadline(); // or what is left of your frame
//! let correction = session.exchange(step, deadline, |positions| positions.copy_from_slice(&cloth))?;
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
//! Modules, each using only those before it: `contacts` (which contacts have to be off); `error`, `registration`;
//! `control` (the connection to a daemon, and requests); `session` (ports, registering again, loans, corrections,
//! paths); `client`; [`observe`] (sessions of others).

mod client;
mod contacts;
pub mod control;
mod error;
pub mod observe;
mod registration;
mod session;

pub use client::{Client, ClientOptions};
pub use contacts::ContactFilter;
pub use error::{
    ConnectError, ExchangeError, FrameRefusal, NewestError, PublishError, RegisterError, RepairError, RequestError,
    WaitError,
};
pub use registration::{Registration, Uvs};
pub use session::{Correction, Loan, LoanMemory, Paths, Repair, Session, StepTime};
pub use untangled_proto::{
    CorrectionHeader, CorrectionKind, Precision, RepairHeader, Status, VertexCorrection, VertexEntry, VertexLabel,
    flags, pair_type,
    paths::{PathPoint, PathRecord, path_type},
};

/// Compiles the first client of the README.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;
