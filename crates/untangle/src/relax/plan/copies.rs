//! Copies of one surface in nearly one place: nothing says which of the two lies outside.

use nalgebra::Vector3;

use crate::{
    frame::Frame,
    intersect::Segment,
    mesh::{FaceId, Mesh, PieceId, VertexId},
};

/// Two copies lie in nearly one place where the mean distance of their vertices is less than this part of the diagonal
/// of the box around one: half a millimetre of a garment. At larger distances they are layers, which pushes set apart.
const NEAR: f64 = 1.0 / 2048.0;

/// Whether most of what intersects is two pieces with the same faces in the same order, whose vertices lie in
/// nearly one place.
///
/// Cost: linear in the mesh where two pieces intersect.
pub(in crate::relax) fn are_copies_in_one_place(mesh: &Mesh, frame: &Frame, segments: &[Segment]) -> bool {
    let between = |segment: &Segment| {
        let [Some(a), Some(b)] = segment.faces.map(|face| mesh.piece(face)) else { return None };
        (a != b).then(|| [a.min(b), a.max(b)])
    };
    let mut meetings: Vec<[PieceId; 2]> = segments.iter().filter_map(between).collect();
    if 2 * meetings.len() <= segments.len() {
        return false;
    }
    meetings.sort_unstable();
    let mut faces: Vec<Vec<FaceId>> = vec![Vec::new(); mesh.num_pieces()];
    for face in mesh.face_ids() {
        if let Some(piece) = mesh.piece(face) {
            faces[piece.index()].push(face);
        }
    }
    let coincide = |[a, b]: [PieceId; 2]| lie_in_one_place(mesh, frame, [&faces[a.index()], &faces[b.index()]]);
    let alike = meetings.chunk_by(|a, b| a == b);
    let num_of_copies: usize = alike.filter(|meeting| coincide(meeting[0])).map(<[_]>::len).sum();
    2 * num_of_copies > segments.len()
}

/// Whether two lists of faces are one list but for the names of vertices, and lie in nearly one place.
fn lie_in_one_place(mesh: &Mesh, frame: &Frame, [first, second]: [&[FaceId]; 2]) -> bool {
    if first.len() != second.len() {
        return false;
    }
    let corners = || first.iter().zip(second).flat_map(|(&a, &b)| mesh.face(a).into_iter().zip(mesh.face(b)));
    let mut twins: Vec<Option<VertexId>> = vec![None; mesh.num_vertices()];
    let are_alike = corners().all(|(vertex, twin)| *twins[vertex.index()].get_or_insert(twin) == twin);
    if !are_alike {
        return false;
    }
    let (mut low, mut high) = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
    for (vertex, _) in corners() {
        let place = frame.position(vertex).coords;
        (low, high) = (low.inf(&place), high.sup(&place));
    }
    let distance_m = |(a, b): (VertexId, VertexId)| (frame.position(a) - frame.position(b)).norm();
    let sum_m: f64 = corners().map(distance_m).sum();
    #[expect(clippy::cast_precision_loss, reason = "a count of corners")]
    let mean_m = sum_m / (3 * first.len()) as f64;
    mean_m < NEAR * (high - low).norm()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{analysis::analyse, mesh::MeshDescription};

    /// A sheet of 6 x 6 m twice, the second one moved and turned a little.
    fn two_sheets(squares: u32, shift_m: f64) -> (Mesh, Frame) {
        let (mut positions, mut faces) = (Vec::new(), Vec::new());
        let row = squares + 1;
        for (copy, tilt) in [(0, 0.0), (1, 1e-3)] {
            let first = row * row * copy;
            for k in 0..row * row {
                let [u, v] = [k % row, k / row].map(|at| 6.0 * f64::from(at) / f64::from(squares));
                positions.push([u + shift_m * f64::from(copy), v, tilt * (u - 3.1)]);
            }
            for k in (0..row * squares).filter(|k| k % row < squares).map(|k| first + k) {
                faces.extend([[k, k + 1, k + row + 1], [k, k + row + 1, k + row]]);
            }
        }
        let num_vertices = positions.len();
        let mesh = Mesh::new(MeshDescription { num_vertices, faces, ..Default::default() }).unwrap();
        let frame = Frame::new(&mesh, &positions).unwrap();
        (mesh, frame)
    }

    #[test]
    fn copies_are_in_one_place_only_where_they_nearly_coincide_however_fine_they_are() {
        for squares in [6, 12, 24] {
            for (shift_m, expected) in [(0.0, true), (0.002, true), (0.02, false), (0.2, false)] {
                let (mesh, frame) = two_sheets(squares, shift_m);
                let segments = &analyse(&mesh, &frame).intersections.segments;
                assert!(!segments.is_empty());
                assert_eq!(are_copies_in_one_place(&mesh, &frame, segments), expected, "{squares} {shift_m} m");
            }
        }
    }
}
