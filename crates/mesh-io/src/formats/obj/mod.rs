//! Wavefront OBJ.
//!
//! Read are `v` (numbers after the position, a weight or a colour, are ignored), `vt` and `f` in all its forms. All
//! other lines (groups, materials, normals, lines, comments) are ignored and kept when the file is written back.

mod join;
mod read;

pub(crate) use join::Before;
pub(crate) use read::{ObjDocument, parse};
