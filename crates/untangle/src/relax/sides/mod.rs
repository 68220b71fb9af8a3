//! Sides of bodies and layers during a relaxation: which free vertices are on the wrong side, and the constraints that
//! bring them out and keep others where they are.
//!
//! | file | purpose |
//! |---|---|
//! | `tracker` | which vertices are inside in a state, by distances that are known from another |
//! | `rows` | constraints along the distance field of the bodies |

mod rows;
mod tracker;

pub(crate) use rows::SideRows;
pub(crate) use tracker::{SideTracker, Wrong};
