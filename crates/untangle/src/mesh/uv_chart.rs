//! Pieces whose texture coordinates are one smooth chart: found once, so that no frame has to unfold them.

use super::{FaceId, Mesh};

/// The texture coordinates of each vertex whose piece is one smooth chart; empty if there is no such piece. What makes
/// a chart smooth is said at [`Mesh::chart_place`].
///
/// Cost: linear in the faces.
pub(super) fn find_uv_places(mesh: &Mesh) -> Vec<Option<[f64; 2]>> {
    let Some(uvs) = mesh.uvs() else { return Vec::new() };
    let corners = |face: FaceId| uvs.corners[face.index()].map(|corner| uvs.coordinates[corner as usize]);
    let used = || mesh.face_ids().filter_map(|face| Some((face, mesh.piece(face)?)));
    let mut places: Vec<Option<[f64; 2]>> = vec![None; mesh.num_vertices()];
    let mut piece_of_vertex = vec![None; mesh.num_vertices()];
    let mut is_chart = vec![true; mesh.num_pieces()];
    for (face, piece) in used() {
        let corners = corners(face);
        is_chart[piece.index()] &= area(corners).abs() > 0.0;
        for (vertex, corner) in mesh.face(face).into_iter().zip(corners) {
            // All faces must give the vertex the same coordinates, bit for bit.
            let [u, v] = *places[vertex.index()].get_or_insert(corner);
            is_chart[piece.index()] &= u.to_bits() == corner[0].to_bits() && v.to_bits() == corner[1].to_bits();
            // Two pieces that share a vertex have unrelated charts, but a vertex can have only one place.
            let first = *piece_of_vertex[vertex.index()].get_or_insert(piece);
            if first != piece {
                is_chart[first.index()] = false;
                is_chart[piece.index()] = false;
            }
        }
    }
    for edge in mesh.edge_ids() {
        let ends = mesh.edge(edge);
        let Some(piece) = mesh.edge_faces(edge).first().and_then(|&face| mesh.piece(face)) else { continue };
        let is_left = |face: &FaceId| {
            let apex = mesh.face(*face).into_iter().find(|corner| !ends.contains(corner));
            let [a, b, c] = [Some(ends[0]), Some(ends[1]), apex].map(|corner| places[corner?.index()]);
            Some(area([a?, b?, c?]) > 0.0)
        };
        let is_seam = match mesh.edge_faces(edge) {
            [first, second] => is_left(first) == is_left(second),
            [_] => false,
            _ => true,
        };
        is_chart[piece.index()] &= !is_seam;
    }
    for (place, piece) in places.iter_mut().zip(&piece_of_vertex) {
        place.take_if(|_| piece.is_none_or(|piece| !is_chart[piece.index()]));
    }
    if !is_chart.contains(&true) {
        places.clear();
    }
    places
}

/// Twice the area of a triangle, negative if it runs clockwise.
fn area([a, b, c]: [[f64; 2]; 3]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{MeshDescription, Uvs};

    /// Two squares side by side, each of two triangles, with coordinates of their own.
    fn places(coordinates: [[f64; 2]; 8]) -> Vec<Option<[f64; 2]>> {
        let faces = vec![[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]];
        let corners = vec![[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]];
        let uvs = Some(Uvs { coordinates: coordinates.to_vec(), corners });
        let mesh = Mesh::new(MeshDescription { num_vertices: 6, faces, uvs, ..Default::default() }).unwrap();
        mesh.vertex_ids().map(|vertex| mesh.chart_place(vertex)).collect()
    }

    const LEFT: [[f64; 2]; 4] = [[0., 0.], [1., 0.], [1., 1.], [0., 1.]];

    fn with_right(right: [[f64; 2]; 4]) -> Vec<Option<[f64; 2]>> {
        let mut all = [[0.0; 2]; 8];
        all[..4].copy_from_slice(&LEFT);
        all[4..].copy_from_slice(&right);
        places(all)
    }

    #[test]
    fn uv_chart_of_squares_that_agree_on_their_edge_covers_both() {
        let expected = [[0., 0.], [1., 0.], [2., 0.], [0., 1.], [1., 1.], [2., 1.]].map(Some);
        assert_eq!(with_right([[1., 0.], [2., 0.], [2., 1.], [1., 1.]]), expected);
    }

    #[test]
    fn uv_chart_with_seam_fold_or_flat_face_is_none() {
        assert_eq!(with_right([[5., 0.], [6., 0.], [6., 1.], [5., 1.]]), [None; 6]);
        assert_eq!(with_right([[1., 0.], [0.5, 0.], [0.5, 1.], [1., 1.]]), [None; 6]);
        assert_eq!(with_right([[1., 0.], [1., 0.], [2., 1.], [1., 1.]]), [None; 6]);
    }
}
