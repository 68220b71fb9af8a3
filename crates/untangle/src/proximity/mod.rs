//! Which primitives are nearer to each other than a distance, and how near the nearest ones are.
//!
//! Barrier solvers (incremental potential contact and its kin) refuse or freeze on states whose primitives are too
//! close, intersecting or not. A *proximity pair* is a vertex and a face of which it is no corner, or two edges without
//! a common vertex. Pairs are decided exactly, each counts once, and those that share a vertex never count, nor those
//! of two bodies. Primitives
//! are those of the faces that are used: vertices of no face, and faces with a repeated vertex, are none.
//!
//! Most pairs are neighbours on the surface. So the test of a vertex star comes first: where it proves that no two
//! primitives of the faces round a vertex are within the margin, no pair of these faces is looked at. What is left goes
//! from boxes through filters in single precision to exact decisions.
//!
//! | file | purpose |
//! |---|---|
//! | `pair` | the pairs, and their closest points |
//! | `goal` | all pairs below a distance, or the nearest one |
//! | `owners` | which face answers for a vertex or an edge |
//! | `stars` | which stars may have near pairs |
//! | `share` | one share of a search, batch by batch through the filters |
//! | `search` | the driver |
//!
//! A row uses those above it only.

mod goal;
mod owners;
mod pair;
mod search;
mod share;
mod stars;
#[cfg(test)]
mod tests;

pub use pair::{ClosestPoints, Primitives, ProximityPair, closest_points};
pub use search::{ProximityEnd, ProximitySearch};
