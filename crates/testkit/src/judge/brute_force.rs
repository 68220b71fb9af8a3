//! Intersections by testing all edges against all faces, from the definition.

use std::collections::BTreeMap;

use untangle::{
    analysis::Analysis,
    frame::Frame,
    mesh::{EdgeId, FaceId, Mesh, VertexId},
    predicates::{Side, Site, side_of_plane},
};

fn site(frame: &Frame, vertex: VertexId) -> Site {
    Site { position: frame.position(vertex).coords.into(), index: vertex.0 }
}

/// All pairs of an edge and a face that it pierces and shares no vertex with, in order.
///
/// Edge `pq` pierces face `abc` when `p` and `q` lie on different sides of `abc` and the three signs of `pq` against
/// `ab`, `bc` and `ca` agree. Time grows with edges times faces.
pub fn edge_face_intersections(mesh: &Mesh, frame: &Frame) -> Vec<(EdgeId, FaceId)> {
    let mut found = Vec::new();
    let mut sides = vec![Side::Above; mesh.num_vertices()];
    for face in mesh.face_ids().filter(|&face| mesh.face_edges(face).is_some()) {
        let corners = mesh.face(face);
        let [a, b, c] = corners.map(|corner| site(frame, corner));
        for vertex in mesh.vertex_ids().filter(|vertex| !corners.contains(vertex)) {
            sides[vertex.index()] = side_of_plane(a, b, c, site(frame, vertex));
        }
        for edge in mesh.edge_ids() {
            let [p, q] = mesh.edge(edge);
            if corners.contains(&p) || corners.contains(&q) || sides[p.index()] == sides[q.index()] {
                continue;
            }
            let [p, q] = [p, q].map(|end| site(frame, end));
            let signs = [(a, b), (b, c), (c, a)].map(|(from, to)| side_of_plane(p, q, from, to));
            if signs[0] == signs[1] && signs[1] == signs[2] {
                found.push((edge, face));
            }
        }
    }
    found.sort_unstable();
    found
}

/// All intersecting pairs of faces with the number of edge-face intersections between them, in order.
pub fn face_pairs(mesh: &Mesh, edge_face: &[(EdgeId, FaceId)]) -> BTreeMap<[FaceId; 2], usize> {
    let mut pairs = BTreeMap::new();
    for &(edge, face) in edge_face {
        for &owner in mesh.edge_faces(edge) {
            *pairs.entry([owner.min(face), owner.max(face)]).or_default() += 1;
        }
    }
    pairs
}

/// Asserts that an analysis has the same edge-face intersections and the same intersecting faces; `name` says of what.
#[track_caller]
pub fn assert_equal(name: &str, mesh: &Mesh, frame: &Frame, analysis: &Analysis) {
    let expected = edge_face_intersections(mesh, frame);
    let found: Vec<(EdgeId, FaceId)> =
        analysis.intersections.edge_face.iter().map(|hit| (hit.edge, hit.face)).collect();
    assert_eq!(found, expected, "{name}");
    let expected: Vec<[FaceId; 2]> = face_pairs(mesh, &expected).into_keys().collect();
    let found: Vec<[FaceId; 2]> = analysis.intersections.segments.iter().map(|segment| segment.faces).collect();
    assert_eq!(found, expected, "{name}");
}
