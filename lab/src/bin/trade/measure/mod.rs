//! Runs of all settings on all scenes, and their figures.

pub(crate) mod exact;
pub(crate) mod run;
pub(crate) mod setup;
pub(crate) mod study;
mod targets;
