//! The mesh itself: validated connectivity, and the questions that may be asked of it.

use super::{Csr, EdgeId, FaceId, MeshIdentity, PieceId, Uvs, VertexId};

/// Validated connectivity of one or several pieces of cloth, and the data of its elements that no frame changes:
/// texture coordinates, rest positions, masses, pins, layers and bodies.
#[derive(Clone, Debug)]
pub struct Mesh {
    pub(super) identity: MeshIdentity,
    pub(super) num_vertices: usize,
    pub(super) faces: Vec<[VertexId; 3]>,
    pub(super) edges: Vec<[VertexId; 2]>,
    pub(super) face_edges: Vec<Option<[EdgeId; 3]>>,
    pub(super) edge_faces: Csr<FaceId>,
    pub(super) vertex_faces: Csr<FaceId>,
    pub(super) vertex_edges: Csr<EdgeId>,
    pub(super) face_piece: Vec<Option<PieceId>>,
    pub(super) num_pieces: usize,
    pub(super) is_solid_piece: Vec<bool>,
    /// One for each vertex, or empty if no piece is a smooth chart.
    pub(super) uv_places: Vec<Option<[f64; 2]>>,
    pub(super) num_boundary_edges: usize,
    pub(super) num_ignored_faces: usize,
    pub(super) manifold: bool,
    pub(super) is_boundary_vertex: Vec<bool>,
    pub(super) uvs: Option<Uvs>,
    pub(super) rest_positions: Option<Vec<[f64; 3]>>,
    pub(super) masses_kg: Option<Vec<f64>>,
    pub(super) is_pinned: Vec<bool>,
    /// One for each vertex, or empty if there is no body.
    pub(super) is_body: Vec<bool>,
    /// For each block of vertices whether all of them belong to bodies; empty if there is no body.
    pub(super) is_body_block: Vec<bool>,
    pub(super) layers: Option<Vec<u32>>,
    /// One for each face, where it is decided.
    pub(super) outwards: Option<Vec<bool>>,
}

/// Vertices that are looked at together, in the order of their ids, where those of bodies are passed over.
pub(crate) const VERTICES_PER_BLOCK: usize = 1024;

impl Mesh {
    /// The largest number of vertices or faces: what 31-bit indices can name.
    pub const MAX_ELEMENTS: usize = 1 << 31;

    /// Equal for clones of this mesh, and different for all other meshes.
    #[must_use]
    pub(crate) fn identity(&self) -> &MeshIdentity {
        &self.identity
    }

    /// Number of vertices of the input, unused ones included.
    #[must_use]
    pub fn num_vertices(&self) -> usize {
        self.num_vertices
    }

    /// Number of faces of the input, ignored ones included.
    #[must_use]
    pub fn num_faces(&self) -> usize {
        self.faces.len()
    }

    /// Number of edges of faces that are not ignored.
    #[must_use]
    pub fn num_edges(&self) -> usize {
        self.edges.len()
    }

    /// Number of pieces.
    #[must_use]
    pub fn num_pieces(&self) -> usize {
        self.num_pieces
    }

    /// Number of edges with exactly one face.
    #[must_use]
    pub fn num_boundary_edges(&self) -> usize {
        self.num_boundary_edges
    }

    /// Number of faces with a repeated vertex.
    #[must_use]
    pub fn num_ignored_faces(&self) -> usize {
        self.num_ignored_faces
    }

    /// Whether there is no boundary edge.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        self.num_boundary_edges == 0
    }

    /// Whether every edge has at most two faces and the faces of every vertex star form one fan.
    #[must_use]
    pub fn is_manifold(&self) -> bool {
        self.manifold
    }

    /// All face ids, ignored faces included.
    pub fn face_ids(&self) -> impl Iterator<Item = FaceId> + Clone + use<> {
        (0..u32::try_from(self.faces.len()).expect("limited at construction")).map(FaceId)
    }

    /// All edge ids.
    pub fn edge_ids(&self) -> impl Iterator<Item = EdgeId> + Clone + use<> {
        (0..u32::try_from(self.edges.len()).expect("limited at construction")).map(EdgeId)
    }

    /// All vertex ids.
    pub fn vertex_ids(&self) -> impl Iterator<Item = VertexId> + Clone + use<> {
        (0..u32::try_from(self.num_vertices).expect("limited at construction")).map(VertexId)
    }

    /// The three vertices of a face, as given.
    #[must_use]
    pub fn face(&self, face: FaceId) -> [VertexId; 3] {
        self.faces[face.index()]
    }

    /// The two vertices of an edge, the lower index first.
    #[must_use]
    pub fn edge(&self, edge: EdgeId) -> [VertexId; 2] {
        self.edges[edge.index()]
    }

    /// The edges of a face; edge `k` joins corners `k` and `k + 1`. Nothing for an ignored face.
    #[must_use]
    pub fn face_edges(&self, face: FaceId) -> Option<[EdgeId; 3]> {
        self.face_edges[face.index()]
    }

    /// The faces of an edge, ascending.
    #[must_use]
    pub fn edge_faces(&self, edge: EdgeId) -> &[FaceId] {
        self.edge_faces.row(edge.index())
    }

    /// The faces round a vertex, ascending, ignored ones left out.
    #[must_use]
    pub fn vertex_faces(&self, vertex: VertexId) -> &[FaceId] {
        self.vertex_faces.row(vertex.index())
    }

    /// The edges of a vertex, ascending.
    #[must_use]
    pub fn vertex_edges(&self, vertex: VertexId) -> &[EdgeId] {
        self.vertex_edges.row(vertex.index())
    }

    /// The edge between two vertices, if there is one.
    #[must_use]
    pub fn edge_between(&self, a: VertexId, b: VertexId) -> Option<EdgeId> {
        let ends = if a < b { [a, b] } else { [b, a] };
        self.vertex_edges(a).iter().copied().find(|&edge| self.edge(edge) == ends)
    }

    /// The vertex of an edge that is not `vertex`.
    #[must_use]
    pub fn opposite_vertex(&self, edge: EdgeId, vertex: VertexId) -> VertexId {
        let [a, b] = self.edge(edge);
        if a == vertex { b } else { a }
    }

    /// Whether exactly one face has this edge.
    #[must_use]
    pub fn is_boundary_edge(&self, edge: EdgeId) -> bool {
        self.edge_faces(edge).len() == 1
    }

    /// Whether a boundary edge ends in this vertex.
    #[must_use]
    pub fn is_boundary_vertex(&self, vertex: VertexId) -> bool {
        self.is_boundary_vertex[vertex.index()]
    }

    /// The piece of a face; nothing for an ignored face.
    #[must_use]
    pub fn piece(&self, face: FaceId) -> Option<PieceId> {
        self.face_piece[face.index()]
    }

    /// Whether a piece is closed and its faces agree on what is outside: each edge has two faces that run along it in
    /// opposite directions.
    #[must_use]
    pub fn is_solid(&self, piece: PieceId) -> bool {
        self.is_solid_piece[piece.index()]
    }

    /// For each piece whether it has no boundary edge.
    ///
    /// Cost: linear in the faces.
    #[must_use]
    pub fn closed_pieces(&self) -> Vec<bool> {
        let mut closed = vec![true; self.num_pieces];
        for face in self.face_ids() {
            if let (Some(piece), Some(edges)) = (self.piece(face), self.face_edges(face))
                && edges.into_iter().any(|edge| self.is_boundary_edge(edge))
            {
                closed[piece.index()] = false;
            }
        }
        closed
    }

    /// Texture coordinates, if there are any.
    #[must_use]
    pub fn uvs(&self) -> Option<&Uvs> {
        self.uvs.as_ref()
    }

    /// The texture coordinates of a vertex, if those of its piece are one smooth chart: all faces agree on their common
    /// vertices, none is folded over a neighbour, and the piece shares no vertex with another one. Any unfolding of
    /// such a piece gives the texture coordinates themselves.
    #[must_use]
    pub fn chart_place(&self, vertex: VertexId) -> Option<[f64; 2]> {
        self.uv_places.get(vertex.index()).copied().flatten()
    }

    /// Unstrained positions in metres, if given.
    #[must_use]
    pub fn rest_positions(&self) -> Option<&[[f64; 3]]> {
        self.rest_positions.as_deref()
    }

    /// Mass of each vertex in kilograms, if given.
    #[must_use]
    pub fn masses_kg(&self) -> Option<&[f64]> {
        self.masses_kg.as_deref()
    }

    /// Whether some vertices belong to bodies.
    #[must_use]
    pub fn has_body(&self) -> bool {
        !self.is_body.is_empty()
    }

    /// The same mesh with more pinned vertices.
    ///
    /// Cost: that of a copy.
    pub(crate) fn with_pins(&self, pins: impl IntoIterator<Item = VertexId>) -> Self {
        let mut mesh = self.clone();
        pins.into_iter().for_each(|pin| mesh.is_pinned[pin.index()] = true);
        mesh
    }

    /// Whether a vertex belongs to a body. Such vertices are [pinned](Self::is_pinned).
    #[must_use]
    #[inline(always)]
    pub fn is_body(&self, vertex: VertexId) -> bool {
        self.has_body() && self.is_body[vertex.index()]
    }

    /// Whether all vertices of a block of [`VERTICES_PER_BLOCK`] belong to bodies.
    pub(crate) fn is_body_block(&self, block: usize) -> bool {
        self.has_body() && self.is_body_block[block]
    }

    /// Whether a face belongs to a body: all of its corners do, or none.
    #[must_use]
    #[inline(always)]
    pub fn is_body_face(&self, face: FaceId) -> bool {
        self.is_body(self.face(face)[0])
    }

    /// Whether the host holds this vertex in place.
    #[must_use]
    pub fn is_pinned(&self, vertex: VertexId) -> bool {
        self.is_pinned[vertex.index()]
    }

    /// Layer of each vertex, if given, from the body outwards; 0 for vertices of bodies.
    #[must_use]
    pub fn layers(&self) -> Option<&[u32]> {
        self.layers.as_deref()
    }

    /// The same mesh with another layer of each vertex, of which it is open what is outwards. Cost: that of a copy.
    pub(crate) fn with_layers(&self, layers: Vec<u32>) -> Self {
        Self { layers: Some(layers), outwards: None, ..self.clone() }
    }

    /// For each face whether its normal points outwards of its layer, where that was decided for good; see
    /// [`Layers::decide`](crate::sides::Layers::decide).
    #[must_use]
    pub fn outwards(&self) -> Option<&[bool]> {
        self.outwards.as_deref()
    }

    /// The same mesh with what is outwards decided, or open again: one entry for each face.
    ///
    /// # Panics
    /// If there are more or less entries than faces.
    #[must_use]
    pub fn with_outwards(self, outwards: Option<&[bool]>) -> Self {
        assert!(outwards.is_none_or(|outwards| outwards.len() == self.num_faces()), "one entry for each face");
        Self { outwards: outwards.map(<[bool]>::to_vec), ..self }
    }
}
