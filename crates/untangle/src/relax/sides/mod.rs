//! Sides of bodies during a relaxation: which free vertices are inside of a body, and the constraints that bring them
//! out and keep others outside.
//!
//! | file | purpose |
//! |---|---|
//! | `tracker` | which vertices are inside in a state, by distances that are known from another |
//! | `rows` | constraints along the distance field of the bodies |

mod rows;
mod tracker;

pub(crate) use rows::SideRows;
pub(crate) use tracker::SideTracker;
