//! Mesh files in and out: OBJ, PLY and glTF; intersection paths as lines.
//!
//! Rules for all formats. Positions are kept in double precision. Nothing is merged, reordered or dropped: vertex `k` of a file is
//! vertex `k` of the mesh, polygons stay polygons in the file and are split into triangles only for the analysis. A file that is
//! written back is the file that was read with other coordinates, byte for byte: a [`MeshFile`] keeps the bytes it came from
//! and where in them each coordinate stands. Input is not trusted: a header that lies costs an error, not memory.
//!
//! | module | purpose |
//! |---|---|
//! | `text` | tokens, numbers and replacement of coordinates in text |
//! | `polygon` | polygons and their triangulation |
//! | `obj`, `ply`, `gltf` | one format each |
//! | `mesh_file` | what all formats come down to; several files as one world |
//! | `output` | which files can become which |
//! | `contours` | intersection paths as lines for other programs |

mod contours;
mod error;
mod gltf;
mod mesh_file;
mod obj;
mod output;
mod ply;
mod polygon;
mod text;

pub use contours::{write_contours_obj, write_contours_ply};
pub use error::{ReadError, ReadErrorKind, WriteError};
pub use mesh_file::{FileFormat, MeshFile, World, concatenate, read_mesh};
pub use obj::write_obj;
pub use output::Output;
pub use ply::write_ply;
pub use polygon::Polygons;

#[cfg(test)]
mod tests;
