//! Mesh files in and out: OBJ, PLY, STL and glTF; vertex caches: PC2, MDD and numbered meshes; shots in USD;
//! intersection paths as lines.
//!
//! - Nothing is merged, reordered or dropped. Vertex `k` of a file is vertex `k` of the mesh; polygons stay polygons in
//!   the file and are split into triangles only for the analysis. Positions are kept in double precision. STL alone has
//!   no vertices: corners of facets that are in one place are one.
//! - A [`MeshFile`] keeps the bytes that it was read from and the byte offset of each coordinate. Written back with
//!   other positions, it differs from the file that was read in the coordinates that changed and in no other byte; in
//!   glTF also in the bounds of positions and in links to buffers that changed, in STL in normals of facets that moved.
//! - Input is not trusted: a header that lies about its lengths costs an error, not memory. A glTF document may ask for
//!   64 bytes of mesh for each of its own, and reads files of its own folder only.
//!
//! ```
//! use untangled_mesh_io::{concatenate, read_mesh};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let folder = tempfile::tempdir()?;
//! let path = folder.path().join("triangle.obj");
//! std::fs::write(&path, "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl wool\nf 1 2 3\n")?;
//!
//! let file = read_mesh(&path)?;
//! let world = concatenate(std::slice::from_ref(&file))?;
//! assert_eq!(world.description.faces, [[0, 1, 2]]);
//!
//! let mut positions = world.positions;
//! positions[2][1] = 1.5;
//! let mut written = Vec::new();
//! file.write_with_positions(&positions, &mut written)?;
//! assert_eq!(written, b"v 0 0 0\nv 1 0 0\nv 0 1.5 0\nusemtl wool\nf 1 2 3\n");
//! # Ok(())
//! # }
//! ```
//!
//! Each module uses those above it in this table only.
//!
//! | module | purpose |
//! |---|---|
//! | `printable` | text of files as a terminal may show it |
//! | `error` | why a file was not read or not written |
//! | `formats` | `obj`, `ply`, `gltf`, `stl`, on `text`, `polygon`, `triangulate`, `part` and `mesh_data` |
//! | `file_format` | the formats by name and by content |
//! | `document` | the bytes of a file in the form of its format, kept to be written back |
//! | `mesh_file` | one file of any format |
//! | `usd` | shots in USD: layers, composition, the meshes below a prim |
//! | `caches` | the positions of a mesh, frame by frame: PC2, MDD, numbered meshes, USD |
//! | `world` | several files in one world |
//! | `output` | one or several files as one file |
//! | `contours` | intersection paths as lines for other programs |

mod caches;
mod contours;
mod document;
mod error;
mod file_format;
mod formats;
mod mesh_file;
mod output;
mod printable;
#[cfg(test)]
mod tests;
mod usd;
mod world;

pub use caches::{CacheError, CacheErrorKind, CacheFrame, Pattern, VertexCache};
pub use contours::{write_contours_obj, write_contours_ply};
pub use error::{ReadError, ReadErrorKind, WriteError};
pub use file_format::FileFormat;
pub use formats::{
    part::{Part, PartName},
    polygon::Polygons,
};
pub use mesh_file::{MeshFile, read_mesh};
pub use output::{Output, write_obj, write_ply};
pub use printable::Printable;
pub use usd::UsdError;
pub use world::{World, concatenate};
