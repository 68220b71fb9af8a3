//! Which end of a crossed edge lies to the left of a path, from the order of the corners of faces alone.
//!
//! A face whose corners run counter-clockwise lies to the left of each of its directed edges. A path that leaves the
//! face over an edge from `a` to `b` has `b` on its left, one that enters it there has `a`. Faces may disagree on which
//! sense of rotation is counter-clockwise; the path carries one sense along, from face to face over its edges and round
//! its loop vertex over the edges of that vertex.

use crate::{
    mesh::{EdgeId, FaceId, Mesh, VertexId},
    paths::{PathPoint, PathSegment, SurfacePoint},
};

/// For each edge that a path crosses, the end on the left where it crosses it first; sorted by edge.
pub(crate) fn left_ends(
    mesh: &Mesh,
    points: &[PathPoint],
    segments: &[PathSegment],
    left: &mut Vec<(EdgeId, usize, VertexId)>,
) {
    left.clear();
    // Whether the faces so far run clockwise, if the first one runs counter-clockwise.
    let mut turned = false;
    for (at, segment) in segments.iter().enumerate() {
        let face = segment.own;
        if let SurfacePoint::Edge { edge, .. } = points[at].own {
            if at == 0 {
                left.push((edge, left.len(), start_of(mesh, face, edge, turned)));
            } else {
                turned ^= runs_alike(mesh, segments[at - 1].own, face, edge);
            }
        } else if at > 0
            && let SurfacePoint::Vertex(vertex) = points[at].own
        {
            turned ^= turns_round(mesh, vertex, segments[at - 1].own, face);
        }
        if let SurfacePoint::Edge { edge, .. } = points[at + 1].own {
            left.push((edge, left.len(), start_of(mesh, face, edge, !turned)));
        }
    }
    // Of an edge that is crossed several times the first crossing counts.
    left.sort_unstable();
    left.dedup_by_key(|&mut (edge, ..)| edge);
}

/// The vertex from which a face runs along an edge, or the other one.
fn start_of(mesh: &Mesh, face: FaceId, edge: EdgeId, other: bool) -> VertexId {
    let [low, high] = mesh.edge(edge);
    if runs_upwards(mesh, face, edge) == other { high } else { low }
}

/// Whether a face runs along its edge from the lower vertex to the higher one.
fn runs_upwards(mesh: &Mesh, face: FaceId, edge: EdgeId) -> bool {
    let ([low, high], corners) = (mesh.edge(edge), mesh.face(face));
    (0..3).any(|corner| corners[corner] == low && corners[(corner + 1) % 3] == high)
}

/// Whether two faces run along their common edge in the same direction, so that one runs clockwise if the other does
/// not.
fn runs_alike(mesh: &Mesh, a: FaceId, b: FaceId, edge: EdgeId) -> bool {
    runs_upwards(mesh, a, edge) == runs_upwards(mesh, b, edge)
}

/// Whether two faces at a vertex disagree in their sense of rotation, told by the faces between them. On one fan at
/// least one way round the vertex leads from face to face, and where two do, both give the same answer.
fn turns_round(mesh: &Mesh, vertex: VertexId, from: FaceId, to: FaceId) -> bool {
    let num_faces = mesh.vertex_faces(vertex).len();
    let spokes = |face: FaceId| {
        mesh.face_edges(face).into_iter().flatten().filter(move |&edge| mesh.edge(edge).contains(&vertex))
    };
    for first in spokes(from) {
        let (mut face, mut spoke, mut turned) = (from, first, false);
        for _ in 0..num_faces {
            if face == to {
                return turned;
            }
            let [a, b] = *mesh.edge_faces(spoke) else { break };
            let next = if a == face { b } else { a };
            turned ^= runs_alike(mesh, face, next, spoke);
            let Some(ahead) = spokes(next).find(|&edge| edge != spoke) else { break };
            (face, spoke) = (next, ahead);
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use nalgebra::Point3;

    use super::*;
    use crate::mesh::MeshDescription;

    /// A hexagon round vertex 0, its faces in any sense of rotation.
    fn hexagon(flipped: u32) -> Mesh {
        let faces = (0..6u32).map(|k| {
            let [a, b] = [k + 1, (k + 1) % 6 + 1];
            if flipped >> k & 1 == 1 { [0, b, a] } else { [0, a, b] }
        });
        Mesh::new(MeshDescription { num_vertices: 7, faces: faces.collect(), ..Default::default() }).unwrap()
    }

    fn on(own: SurfacePoint) -> PathPoint {
        PathPoint { position: Point3::origin(), own, partner: own }
    }

    #[test]
    fn left_ends_of_faces_in_any_sense_are_on_one_side() {
        for flipped in 0..64 {
            let mesh = hexagon(flipped);
            let edge = |a, b| mesh.edge_between(VertexId(a), VertexId(b)).unwrap();
            let at = |a, b| on(SurfacePoint::Edge { edge: edge(a, b), parameter: 0.5 });
            // In over the rim, on over a spoke, through the middle, out over the rim opposite; corners run
            // counter-clockwise.
            let points = [at(1, 2), at(0, 2), on(SurfacePoint::Vertex(VertexId(0))), at(5, 6)];
            let segments = [0, 1, 4].map(|face| PathSegment { own: FaceId(face), partner: FaceId(face) });
            let mut left = Vec::new();
            left_ends(&mesh, &points, &segments, &mut left);
            let end = |edge: EdgeId| left[left.binary_search_by_key(&edge, |&(edge, ..)| edge).unwrap()].2.0;
            let found = [end(edge(1, 2)), end(edge(0, 2)), end(edge(5, 6))];
            // The sense of rotation is that of the first face.
            let expected = if flipped & 1 == 0 { [1, 0, 6] } else { [2, 2, 5] };
            assert_eq!(found, expected, "flipped {flipped:b}");
        }
    }
}
