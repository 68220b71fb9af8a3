//! Shots: generated cloth on a moving body, frame by frame, and vertex caches of it.

mod caches;
mod flap;

pub use caches::{mdd, numbered_obj, pc2, usda, usda_points};
pub use flap::{FlapShot, Tangle};
