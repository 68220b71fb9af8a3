//! Resolves cloth intersections: global intersection analysis of one state of a cloth, and the corrections that bring it apart.
//!
//! The method is that of Wicke, Lanker and Gross, "Untangling Cloth With Boundaries" (2006), with exact signs.
//! Modules stand in the order in which data passes through them; each uses only those above it.

pub mod predicates;

pub mod mesh;
pub mod settings;

pub mod frame;

pub mod intersect;

pub mod paths;

pub mod regions;

pub mod analysis;

pub mod correspond;

pub mod respond;

pub mod untangler;

pub mod io;

#[cfg(feature = "daemon")]
pub mod service;

#[cfg(feature = "daemon")]
pub mod config;

#[cfg(feature = "daemon")]
pub mod telemetry;

#[cfg(feature = "daemon")]
pub mod cli;
