//! Wavefront OBJ.
//!
//! Understood are `v` (with weight or colour after the position, both left as they are), `vt` and `f` in all its forms. All
//! else (groups, materials, normals, lines, comments) is not looked at and stays in the file when that is written back.

mod join;
mod read;
mod write;

pub(super) use read::{ObjDocument, parse};
pub use write::write_obj;
