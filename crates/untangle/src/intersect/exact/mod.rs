//! Narrow phase: edge-face tests of one pair of faces with exact signs, and where an edge pierces a face.
//!
//! On the perturbed input (see [`predicates`](crate::predicates)) the edge-face intersections of a pair are:
//!
//! | common vertices | intersections | contact | tested by |
//! |---|---|---|---|
//! | none | 0 or 2 | [`Contact::Crossings`] | [`disjoint`] |
//! | one | 0 or 1 | [`Contact::FromLoopVertex`] | [`one_vertex`] |
//! | two (an edge) | 0 | | |
//!
//! There are no other cases: anything else is a panic with the ids of the faces.

mod contact;
mod corners;
mod directions;
mod disjoint;
mod locate;
mod one_vertex;
mod pair;

pub(crate) use contact::{Contact, Crossing};
pub(crate) use disjoint::contact_of_disjoint;
pub(crate) use locate::locate;
pub(crate) use one_vertex::VertexStar;
pub use pair::do_intersect;
