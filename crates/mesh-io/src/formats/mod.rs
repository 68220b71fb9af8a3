//! The formats: each reads a whole file into [`MeshData`](mesh_data::MeshData) and a document, which keeps the bytes of
//! the file and writes them back with other positions. Nothing here knows [`MeshFile`](crate::MeshFile).

pub(crate) mod gltf;
pub(crate) mod mesh_data;
pub(crate) mod obj;
pub(crate) mod part;
pub(crate) mod ply;
pub(crate) mod polygon;
pub(crate) mod stl;
pub(crate) mod text;
pub(crate) mod triangulate;
