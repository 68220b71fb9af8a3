//! An example host of untangled: a small but honest cloth simulator that publishes its steps and applies the
//! corrections.
//!
//! Read [`host`] first: it is the loop that any simulator needs to talk to the daemon. The rest is the simulator: a
//! [`mesh`], a [`solver`] with self-contact of its own, [`scenes`] to start from, [`obj`] files and a [command
//! line](cli). The exact check (`untangled-checker`) shares no code with the untangler, nor does [`obj`], so that they
//! can judge it.

pub mod cli;
pub mod host;
pub mod mesh;
pub mod obj;
pub mod repairs;
pub mod report;
pub mod run;
pub mod scenes;
pub mod solver;
mod values;
