//! From a description to a validated mesh: the one place where input is doubted.

use super::{Csr, EdgeId, FaceId, Mesh, MeshDescription, MeshError, PieceId, Topology, VertexId, chart::Chart};

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
        let MeshDescription { num_vertices, faces, uvs, rest_positions, masses_kg, pins, layers } = description;
        let faces: Vec<[VertexId; 3]> = faces.into_iter().map(|corners| corners.map(VertexId)).collect();

        let Edges { edges, face_edges } = number_edges(&faces);
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

        let mut is_boundary_vertex = vec![false; num_vertices];
        let mut num_boundary_edges = 0;
        let mut edges_manifold = true;
        for (edge, ends) in edges.iter().enumerate() {
            match edge_faces.row(edge).len() {
                1 => {
                    num_boundary_edges += 1;
                    for end in ends {
                        is_boundary_vertex[end.index()] = true;
                    }
                }
                2 => {}
                _ => edges_manifold = false,
            }
        }
        let mut is_pinned = vec![false; num_vertices];
        for pin in pins {
            is_pinned[pin as usize] = true;
        }
        let (face_piece, num_pieces) = number_pieces(&face_edges, &edge_faces);
        let num_ignored_faces = face_edges.iter().filter(|edges| edges.is_none()).count();

        let mut mesh = Self {
            topology: Topology::default(),
            num_vertices,
            faces,
            edges,
            face_edges,
            edge_faces,
            vertex_faces,
            vertex_edges,
            face_piece,
            num_pieces,
            is_solid_piece: Vec::new(),
            chart: Chart::default(),
            num_boundary_edges,
            num_ignored_faces,
            manifold: edges_manifold,
            is_boundary_vertex,
            uvs,
            rest_positions,
            masses_kg,
            is_pinned,
            layers,
        };
        mesh.manifold = edges_manifold && mesh.vertex_ids().all(|vertex| mesh.is_one_fan(vertex));
        mesh.is_solid_piece = mesh.find_solid_pieces();
        mesh.chart = Chart::find(&mesh);
        Ok(mesh)
    }

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

/// Refuses what can't be a mesh, with the first reason found.
fn validate(description: &MeshDescription) -> Result<(), MeshError> {
    let num_vertices = description.num_vertices;
    let num_faces = description.faces.len();
    if num_vertices == 0 || num_faces == 0 {
        return Err(MeshError::Empty { num_vertices, num_faces });
    }
    for (what, count) in [("vertices", num_vertices), ("faces", num_faces)] {
        // Three times as many edges and corners must fit 32 bits too.
        let limit = Mesh::MAX_ELEMENTS / 4;
        if count > limit {
            return Err(MeshError::TooLarge { what, count, limit });
        }
    }
    for (face, corners) in description.faces.iter().enumerate() {
        if let Some(&index) = corners.iter().find(|&&index| index as usize >= num_vertices) {
            return Err(MeshError::VertexIndex { face, index, num_vertices });
        }
    }
    if !description.faces.iter().any(|corners| is_usable(*corners)) {
        return Err(MeshError::NoUsableFace { num_faces });
    }
    validate_sections(description)
}

fn validate_sections(description: &MeshDescription) -> Result<(), MeshError> {
    let num_vertices = description.num_vertices;
    if let Some(uvs) = &description.uvs {
        check_length("uv_corners", uvs.corners.len(), description.faces.len())?;
        for (entry, corners) in uvs.corners.iter().enumerate() {
            if let Some(&index) = corners.iter().find(|&&index| index as usize >= uvs.coordinates.len()) {
                return Err(MeshError::SectionIndex {
                    section: "uv_corners",
                    entry,
                    index,
                    limit: uvs.coordinates.len(),
                });
            }
        }
        check_finite("uv_coordinates", &uvs.coordinates)?;
    }
    if let Some(rest) = &description.rest_positions {
        check_length("rest_positions", rest.len(), num_vertices)?;
        check_finite("rest_positions", rest)?;
    }
    if let Some(masses) = &description.masses_kg {
        check_length("masses", masses.len(), num_vertices)?;
        for (entry, &value) in masses.iter().enumerate() {
            if !(value.is_finite() && value >= 0.0) {
                return Err(MeshError::SectionValue {
                    section: "masses",
                    entry,
                    value,
                    expected: "finite and not negative",
                });
            }
        }
    }
    if let Some(layers) = &description.layers {
        check_length("layers", layers.len(), num_vertices)?;
    }
    for (entry, &index) in description.pins.iter().enumerate() {
        if index as usize >= num_vertices {
            return Err(MeshError::SectionIndex { section: "pins", entry, index, limit: num_vertices });
        }
    }
    Ok(())
}

fn check_length(section: &'static str, given: usize, expected: usize) -> Result<(), MeshError> {
    if given == expected { Ok(()) } else { Err(MeshError::SectionLength { section, given, expected }) }
}

fn check_finite<const N: usize>(section: &'static str, rows: &[[f64; N]]) -> Result<(), MeshError> {
    for (entry, row) in rows.iter().enumerate() {
        if let Some(&value) = row.iter().find(|value| !value.is_finite()) {
            return Err(MeshError::SectionValue { section, entry, value, expected: "finite" });
        }
    }
    Ok(())
}

fn is_usable([a, b, c]: [u32; 3]) -> bool {
    a != b && b != c && c != a
}

struct Edges {
    edges: Vec<[VertexId; 2]>,
    face_edges: Vec<Option<[EdgeId; 3]>>,
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
    fn two_triangles_share_an_edge() {
        let mesh = mesh(4, &[[0, 1, 2], [2, 1, 3]]);
        assert_eq!((mesh.num_edges(), mesh.num_boundary_edges(), mesh.num_pieces()), (5, 4, 1));
        assert!(mesh.is_manifold() && !mesh.is_closed());
        let shared = mesh.edge_between(VertexId(2), VertexId(1)).unwrap();
        assert_eq!(mesh.edge_faces(shared), [FaceId(0), FaceId(1)]);
        assert!(!mesh.is_boundary_edge(shared));
    }

    #[test]
    fn a_tetrahedron_is_closed() {
        let mesh = mesh(4, &[[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]]);
        assert!(mesh.is_closed() && mesh.is_manifold());
    }

    #[test]
    fn non_manifold_edge_and_vertex_are_found() {
        assert!(!mesh(5, &[[0, 1, 2], [0, 1, 3], [0, 1, 4]]).is_manifold());
        let bow = mesh(5, &[[0, 1, 2], [0, 3, 4]]);
        assert!(!bow.is_manifold());
        assert_eq!(bow.num_pieces(), 2);
    }

    #[test]
    fn a_repeated_index_is_ignored_and_counted() {
        let mesh = mesh(4, &[[0, 1, 2], [1, 1, 3]]);
        assert_eq!((mesh.num_faces(), mesh.num_ignored_faces(), mesh.num_edges()), (2, 1, 3));
        assert_eq!(mesh.face_edges(FaceId(1)), None);
        assert_eq!(mesh.piece(FaceId(1)), None);
    }

    #[test]
    fn bad_input_names_the_element() {
        let error = |description| Mesh::new(description).unwrap_err();
        assert_eq!(error(MeshDescription::default()), MeshError::Empty { num_vertices: 0, num_faces: 0 });
        let faces = vec![[0, 1, 2], [0, 7, 1]];
        let description = MeshDescription { num_vertices: 3, faces, ..Default::default() };
        assert_eq!(error(description), MeshError::VertexIndex { face: 1, index: 7, num_vertices: 3 });
        let description = MeshDescription { num_vertices: 3, faces: vec![[0, 0, 1]], ..Default::default() };
        assert_eq!(error(description), MeshError::NoUsableFace { num_faces: 1 });
        let good = MeshDescription { num_vertices: 3, faces: vec![[0, 1, 2]], ..Default::default() };
        let description = MeshDescription { masses_kg: Some(vec![1.0]), ..good.clone() };
        assert_eq!(error(description), MeshError::SectionLength { section: "masses", given: 1, expected: 3 });
        let description = MeshDescription { pins: vec![3], ..good.clone() };
        assert_eq!(error(description), MeshError::SectionIndex { section: "pins", entry: 0, index: 3, limit: 3 });
        let description = MeshDescription { masses_kg: Some(vec![1.0, -1.0, 1.0]), ..good };
        assert!(matches!(error(description), MeshError::SectionValue { entry: 1, .. }));
    }
}
