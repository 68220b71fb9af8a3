//! What a caller says about a cloth, before anything is checked.

/// A mesh as it comes from a file or over the wire. Only `num_vertices` and `faces` are required.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshDescription {
    /// Number of vertices; vertices that no face uses are allowed.
    pub num_vertices: usize,
    /// Triangles, `num_faces x 3` vertex indices.
    pub faces: Vec<[u32; 3]>,
    /// Texture coordinates with indices of their own.
    pub uvs: Option<Uvs>,
    /// Unstrained positions in metres, `num_vertices x 3`.
    pub rest_positions: Option<Vec<[f64; 3]>>,
    /// Mass of each vertex in kilograms, `num_vertices`.
    pub masses_kg: Option<Vec<f64>>,
    /// Vertices that the host does not let move.
    pub pins: Vec<u32>,
    /// Layer of each vertex, `num_vertices`, from the body outwards; that of vertices of bodies plays no part.
    pub layers: Option<Vec<u32>>,
    /// Vertices of bodies: kinematic, moved by the host alone, and pinned here. Faces have all or none of their corners
    /// among them. Cloth belongs outside; two faces of bodies are never searched for intersections.
    pub body: Vec<u32>,
}

/// Texture coordinates: an atlas in which a corner, not a vertex, has its place.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Uvs {
    /// `num_coordinates x 2`.
    pub coordinates: Vec<[f64; 2]>,
    /// For each face the coordinate index of its three corners, `num_faces x 3`.
    pub corners: Vec<[u32; 3]>,
}
