//! What all formats come down to.

use super::{part::Part, polygon::Polygons};

/// The geometry of one file, as its parser found it.
#[derive(Clone, Debug, Default)]
pub(crate) struct MeshData {
    /// `num_vertices x 3`, finite; taken as metres.
    pub(crate) positions: Vec<[f64; 3]>,
    /// `num_coordinates x 2`, finite; used by the corners of the polygons.
    pub(crate) uv_coordinates: Vec<[f64; 2]>,
    /// The faces.
    pub(crate) polygons: Polygons,
    /// The named parts, whose `faces` count polygons.
    pub(crate) parts: Vec<Part>,
}
