//! PLY, the polygon file format of Stanford: ascii, binary little-endian and binary big-endian.
//!
//! The element `vertex` with the scalars `x`, `y`, `z` and the element `face` with a list `vertex_indices` (or
//! `vertex_index`) make the mesh. Texture coordinates are a list `texcoord` of a face, or scalars of a vertex (`s t`,
//! `u v`, `texture_u texture_v`). Other elements and properties are skipped, and kept when the file is written back.

mod header;
mod read;
mod write;

pub(crate) use read::{PlyDocument, parse};
