//! Which primitives are nearer to each other than a distance, and how near the nearest ones are.
//!
//! Barrier solvers (incremental potential contact and its kin) refuse or freeze on states whose primitives are too
//! close, intersecting or not. A *proximity pair* is a vertex and a face of which it is no corner, or two edges without
//! a common vertex. Pairs are decided exactly, each counts once, and those that share a vertex never count, nor those
//! of two bodies. Primitives
//! are those of the faces that are used: vertices of no face, and faces with a repeated vertex, are none.
//!
//! | file | purpose |
//! |---|---|
//! | `pair` | the pairs, and their closest points |
//! | `elements` | the vertices and edges of each leaf of the tree, with their boxes |
//! | `candidates` | pairs of two leaves whose boxes come near each other |
//! | `search` | all pairs below a distance |
//! | `nearest` | the nearest pair, by branch and bound |
//!
//! A row uses those above it only.

mod candidates;
mod elements;
mod nearest;
mod pair;
mod search;
#[cfg(test)]
mod tests;

pub use pair::{ClosestPoints, Primitives, ProximityPair, closest_points};
pub use search::{ProximityEnd, ProximitySearch};
