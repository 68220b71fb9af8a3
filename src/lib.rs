//! The daemon and the command line of `untangled`. The algorithm is the library `untangle`.
//!
//! This crate is a program: its modules are public for its own tests and measurements, and may change at any time.

pub mod cli;
pub mod config;
mod http;
mod overlay;
pub mod service;
pub mod telemetry;
