//! Intersections, paths and regions, from the outside.
#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

mod invariance;
mod limits;
mod oracle;
mod paths;
mod regions;
