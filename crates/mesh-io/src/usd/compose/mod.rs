//! Composition: what all layers together say of a prim.
//!
//! Sublayers, references, payloads and variants are composed in the order of strength of USD. Classes (inherits,
//! specializes) that say nothing are passed over; what else brings opinions in is refused, with the prim at fault.
//! Source: the AOUSD Core Specification 1.0, section 10.
//!
//! | file | purpose |
//! |---|---|
//! | `stacks` | layers, and the sublayers below them |
//! | `tree` | where opinions on one prim stand, by strength |
//! | `expand` | the arcs of a prim, followed |
//! | `prim` | a composed prim: its children and attributes |

mod expand;
mod prim;
mod stacks;
mod tree;

pub(in crate::usd) use prim::{Attribute, ComposedPrim};
pub(in crate::usd) use stacks::Stage;
