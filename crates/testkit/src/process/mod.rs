//! Daemons and clients as processes, each test's on a domain of its own.

mod client;
mod cloth;
mod daemon;
mod domain;
mod known_cloth;
mod observer;
mod peer;
mod program;
mod wait;

pub use client::{ClientProcess, client_main};
pub use cloth::{STEP, fill_flat, sheet};
pub use daemon::{Daemon, Programs, pid, send_signal};
pub use domain::TestDomain;
pub use known_cloth::KnownCloth;
pub use observer::OBSERVER_NAME;
pub use peer::{RawPeer, RawSession, header, node, session_service_name};
pub(crate) use program::build_folder;
pub use program::{serve, this_test, untangled};
pub use wait::{PATIENCE, eventually, eventually_no_more};
