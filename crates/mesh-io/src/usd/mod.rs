//! Shots in USD: the meshes below a prim, frame by frame, and a layer over them.
//!
//! A reader of its own, and not one of a library, for three reasons: values stay in their file until a frame is asked
//! for, so that memory is needed for a few frames only; lengths are checked before anything is allocated, and nothing
//! that a file says ends in a panic; and what composes a whole stage takes minutes to build. The price is composition:
//! what `compose` says is read, and all else is refused in words that name the prim.
//!
//! Each module uses those above it in this table only.
//!
//! | module | purpose |
//! |---|---|
//! | `fault` | why USD was not read |
//! | `layers` | layers of any format, and what they say of prims |
//! | `compose` | what all layers together say of a prim |
//! | `xform`, `place` | where a mesh is |
//! | `mesh`, `gather` | a mesh prim; the meshes below a prim |
//! | `shot` | frames |
//! | `write` | the layer with corrected points |

mod compose;
mod fault;
mod gather;
mod layers;
mod mesh;
mod place;
mod shot;
mod write;
mod xform;

pub use fault::UsdError;
pub(crate) use place::Place;
pub(crate) use shot::{UsdShot, positions};
