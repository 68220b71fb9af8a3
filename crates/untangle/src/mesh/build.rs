//! From a description to a mesh: edges are numbered, incidences collected, pieces found.

use super::{
    Csr, EdgeId, FaceId, Mesh, MeshDescription, MeshError, MeshIdentity, PieceId, VertexId,
    connectivity::VERTICES_PER_BLOCK,
    uv_chart::find_uv_places,
    validate::{is_usable, validate},
};

impl Mesh {
    /// Validates a description and derives its connectivity.
    ///
    /// Nothing is merged, reordered or dropped: ids are the positions in the input.
    ///
    /// # Errors
    /// [`MeshError`], naming the element at fault.
    ///
    /// Cost: O(n log n) time, some 100 bytes a face.
    pub fn new(description: MeshDescription) -> Result<Self, MeshError> {
        validate(&description)?;
        let is_body = description.are_body_vertices();
        let MeshDescription { num_vertices, faces, uvs, rest_positions, masses_kg, pins, mut layers, body } =
            description;
        for (number, _) in layers.iter_mut().flatten().zip(&is_body).filter(|(_, is_body)| **is_body) {
            // Whatever it was given: no layer belongs inside of a body.
            *number = 0;
        }
        let faces: Vec<[VertexId; 3]> = faces.into_iter().map(|corners| corners.map(VertexId)).collect();

        let Edges { edges, face_edges } = number_edges(&faces);
        let incidence = Incidence::find(num_vertices, &faces, &edges, &face_edges);
        let boundary = Boundary::find(num_vertices, &edges, &incidence.edge_faces);
        let (face_piece, num_pieces) = number_pieces(&face_edges, &incidence.edge_faces);
        let num_ignored_faces = face_edges.iter().filter(|edges| edges.is_none()).count();
        let mut is_pinned = vec![false; num_vertices];
        for pin in pins.into_iter().chain(body) {
            is_pinned[pin as usize] = true;
        }

        let mut mesh = Self {
            identity: MeshIdentity::default(),
            num_vertices,
            faces,
            edges,
            face_edges,
            edge_faces: incidence.edge_faces,
            vertex_faces: incidence.vertex_faces,
            vertex_edges: incidence.vertex_edges,
            face_piece,
            num_pieces,
            is_solid_piece: Vec::new(),
            uv_places: Vec::new(),
            num_boundary_edges: boundary.num_edges,
            num_ignored_faces,
            manifold: boundary.edges_are_manifold,
            is_boundary_vertex: boundary.is_boundary_vertex,
            uvs,
            rest_positions,
            masses_kg,
            is_pinned,
            is_body_block: is_body.chunks(VERTICES_PER_BLOCK).map(|block| !block.contains(&false)).collect(),
            is_body,
            layers,
            outwards: None,
        };
        mesh.manifold = mesh.manifold && mesh.vertex_ids().all(|vertex| mesh.is_one_fan(vertex));
        mesh.is_solid_piece = mesh.find_solid_pieces();
        mesh.uv_places = find_uv_places(&mesh);
        Ok(mesh)
    }

    /// For each piece whether it is closed and consistently oriented; see [`Mesh::is_solid`].
    fn find_solid_pieces(&self) -> Vec<bool> {
        let mut solid = vec![true; self.num_pieces];
        for edge in self.edge_ids() {
            let runs_forward = |face: &FaceId| {
                let ([a, b], corners) = (self.edge(edge), self.face(*face));
                (0..3).any(|corner| corners[corner] == a && corners[(corner + 1) % 3] == b)
            };
            let faces = self.edge_faces(edge);
            let is_seam = faces.len() == 2 && runs_forward(&faces[0]) != runs_forward(&faces[1]);
            if let (false, Some(piece)) = (is_seam, faces.first().and_then(|&face| self.piece(face))) {
                solid[piece.index()] = false;
            }
        }
        solid
    }

    /// Whether the faces round a vertex are connected by edges of that vertex.
    fn is_one_fan(&self, vertex: VertexId) -> bool {
        let faces = self.vertex_faces(vertex);
        let Some(&first) = faces.first() else { return true };
        // Few faces are marked in one word; a vertex may have any number.
        let mut marks = vec![0u64; faces.len().div_ceil(64)];
        let mut mark = |face: FaceId| {
            let at = faces.partition_point(|&other| other < face);
            let is_new = marks[at / 64] >> (at % 64) & 1 == 0;
            marks[at / 64] |= 1 << (at % 64);
            is_new
        };
        mark(first);
        let mut reached = vec![first];
        let mut next = 0;
        while next < reached.len() {
            let spokes = self.face_edges(reached[next]).into_iter().flatten();
            for edge in spokes.filter(|&edge| self.edge(edge).contains(&vertex)) {
                reached.extend(self.edge_faces(edge).iter().copied().filter(|&neighbour| mark(neighbour)));
            }
            next += 1;
        }
        reached.len() == faces.len()
    }
}

/// Edges by their number, and the numbers of the edges of each usable face.
struct Edges {
    edges: Vec<[VertexId; 2]>,
    face_edges: Vec<Option<[EdgeId; 3]>>,
}

/// What is incident to each edge and each vertex.
struct Incidence {
    edge_faces: Csr<FaceId>,
    vertex_faces: Csr<FaceId>,
    vertex_edges: Csr<EdgeId>,
}

impl Incidence {
    fn find(
        num_vertices: usize,
        faces: &[[VertexId; 3]],
        edges: &[[VertexId; 2]],
        face_edges: &[Option<[EdgeId; 3]>],
    ) -> Self {
        let used = || face_edges.iter().enumerate().filter_map(|(face, edges)| edges.map(|edges| (face, edges)));
        let edge_faces = Csr::from_pairs(
            edges.len(),
            used().flat_map(|(face, edges)| edges.map(|edge| (edge.index(), FaceId::from_index(face)))),
        );
        let vertex_faces = Csr::from_pairs(
            num_vertices,
            used().flat_map(|(face, _)| faces[face].map(|vertex| (vertex.index(), FaceId::from_index(face)))),
        );
        let vertex_edges = Csr::from_pairs(
            num_vertices,
            edges.iter().enumerate().flat_map(|(edge, ends)| ends.map(|end| (end.index(), EdgeId::from_index(edge)))),
        );
        Self { edge_faces, vertex_faces, vertex_edges }
    }
}

/// Edges of one face and the vertices on them, and whether no edge has more than two faces.
struct Boundary {
    num_edges: usize,
    is_boundary_vertex: Vec<bool>,
    edges_are_manifold: bool,
}

impl Boundary {
    fn find(num_vertices: usize, edges: &[[VertexId; 2]], edge_faces: &Csr<FaceId>) -> Self {
        let mut boundary =
            Self { num_edges: 0, is_boundary_vertex: vec![false; num_vertices], edges_are_manifold: true };
        for (edge, ends) in edges.iter().enumerate() {
            match edge_faces.row(edge).len() {
                1 => {
                    boundary.num_edges += 1;
                    for end in ends {
                        boundary.is_boundary_vertex[end.index()] = true;
                    }
                }
                2 => {}
                _ => boundary.edges_are_manifold = false,
            }
        }
        boundary
    }
}

/// Numbers the edges in the order of their vertices, so that the numbers don't depend on the order of the faces.
fn number_edges(faces: &[[VertexId; 3]]) -> Edges {
    let mut sides: Vec<([VertexId; 2], u32, u8)> = Vec::with_capacity(3 * faces.len());
    for (face, corners) in (0u32..).zip(faces) {
        if !is_usable(corners.map(|corner| corner.0)) {
            continue;
        }
        for corner in 0..3u8 {
            let a = corners[usize::from(corner)];
            let b = corners[(usize::from(corner) + 1) % 3];
            sides.push((if a < b { [a, b] } else { [b, a] }, face, corner));
        }
    }
    sides.sort_unstable();
    let mut edges: Vec<[VertexId; 2]> = Vec::with_capacity(sides.len() / 2 + 1);
    let mut face_edges = vec![None; faces.len()];
    for (ends, face, corner) in sides {
        if edges.last() != Some(&ends) {
            edges.push(ends);
        }
        let slots = face_edges[face as usize].get_or_insert([EdgeId(0); 3]);
        slots[usize::from(corner)] = EdgeId::from_index(edges.len() - 1);
    }
    Edges { edges, face_edges }
}

/// Numbers the sets of faces connected by edges, in the order of their lowest face.
fn number_pieces(face_edges: &[Option<[EdgeId; 3]>], edge_faces: &Csr<FaceId>) -> (Vec<Option<PieceId>>, usize) {
    let mut face_piece: Vec<Option<PieceId>> = vec![None; face_edges.len()];
    let mut num_pieces = 0;
    let mut stack = Vec::new();
    for first in 0..face_edges.len() {
        if face_edges[first].is_none() || face_piece[first].is_some() {
            continue;
        }
        let piece = PieceId::from_index(num_pieces);
        num_pieces += 1;
        face_piece[first] = Some(piece);
        stack.push(first);
        while let Some(face) = stack.pop() {
            for edge in face_edges[face].into_iter().flatten() {
                for &neighbour in edge_faces.row(edge.index()) {
                    let slot = &mut face_piece[neighbour.index()];
                    if slot.is_none() {
                        *slot = Some(piece);
                        stack.push(neighbour.index());
                    }
                }
            }
        }
    }
    (face_piece, num_pieces)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mesh(num_vertices: usize, faces: &[[u32; 3]]) -> Mesh {
        Mesh::new(MeshDescription { num_vertices, faces: faces.to_vec(), ..Default::default() }).unwrap()
    }

    #[test]
    fn mesh_of_two_triangles_shares_their_edge() {
        let mesh = mesh(4, &[[0, 1, 2], [2, 1, 3]]);
        assert_eq!((mesh.num_edges(), mesh.num_boundary_edges(), mesh.num_pieces()), (5, 4, 1));
        assert!(mesh.is_manifold() && !mesh.is_closed());
        let shared = mesh.edge_between(VertexId(2), VertexId(1)).unwrap();
        assert_eq!(mesh.edge_faces(shared), [FaceId(0), FaceId(1)]);
        assert!(!mesh.is_boundary_edge(shared));
    }

    #[test]
    fn mesh_of_tetrahedron_is_closed_and_manifold() {
        let mesh = mesh(4, &[[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]]);
        assert!(mesh.is_closed() && mesh.is_manifold());
    }

    #[test]
    fn mesh_with_non_manifold_edge_or_vertex_is_not_manifold() {
        assert!(!mesh(5, &[[0, 1, 2], [0, 1, 3], [0, 1, 4]]).is_manifold());
        let bow = mesh(5, &[[0, 1, 2], [0, 3, 4]]);
        assert!(!bow.is_manifold());
        assert_eq!(bow.num_pieces(), 2);
    }

    #[test]
    fn mesh_ignores_and_counts_faces_with_repeated_index() {
        let mesh = mesh(4, &[[0, 1, 2], [1, 1, 3]]);
        assert_eq!((mesh.num_faces(), mesh.num_ignored_faces(), mesh.num_edges()), (2, 1, 3));
        assert_eq!(mesh.face_edges(FaceId(1)), None);
        assert_eq!(mesh.piece(FaceId(1)), None);
    }
}
