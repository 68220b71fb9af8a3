//! Faces that have one vertex in common and nothing else: where they intersect beyond it.

use super::{
    contact::{Contact, Crossing},
    corners::Corners,
};
use crate::{
    frame::Frame,
    mesh::{FaceId, Mesh, VertexId},
    predicates::side_of_plane,
};

/// Tests one pair of usable faces that have one vertex in common and nothing else.
pub(super) fn contact_beyond_vertex(
    mesh: &Mesh,
    frame: &Frame,
    faces: [FaceId; 2],
    vertex: VertexId,
) -> Option<Contact> {
    let [a, b] = faces.map(|face| Corners::of(mesh, frame, face).from(vertex));
    crossing(mesh, &a, &b).map(|crossing| Contact::FromLoopVertex(crossing, vertex))
}

/// The faces around one vertex, tested pair by pair, reusing the memory from vertex to vertex.
#[derive(Debug, Default)]
pub(crate) struct VertexStar {
    /// Each starts at the vertex.
    faces: Vec<Corners>,
}

impl VertexStar {
    /// Tests all pairs of faces that have `vertex` in common and nothing else, and calls `found` with those that
    /// intersect beyond it, the lower face first.
    ///
    /// Which pairs these are is known from the topology alone. Cost: quadratic in the faces around the vertex; most
    /// pairs end after two signs.
    pub(crate) fn contacts(
        &mut self,
        mesh: &Mesh,
        frame: &Frame,
        vertex: VertexId,
        found: &mut impl FnMut([FaceId; 2], Contact),
    ) {
        self.faces.clear();
        self.faces.extend(mesh.vertex_faces(vertex).iter().map(|&face| Corners::of(mesh, frame, face).from(vertex)));
        for (at, a) in self.faces.iter().enumerate() {
            for b in &self.faces[at + 1..] {
                if let Some(crossing) = crossing(mesh, a, b) {
                    found([a.face, b.face], Contact::FromLoopVertex(crossing, vertex));
                }
            }
        }
    }
}

/// Where one of two faces that start at their common vertex is pierced by the other's opposite edge.
fn crossing(mesh: &Mesh, a: &Corners, b: &Corners) -> Option<Crossing> {
    let ([_, p, q], [_, r, s]) = (a.vertices, b.vertices);
    if p == r || p == s || q == r || q == s {
        return None;
    }
    // A face that lies on one side of the other's plane, except for the common vertex, can't reach it.
    let plane = a.plane();
    let [over_r, over_s] = [b.sites[1], b.sites[2]].map(|site| plane.side_of(site));
    if over_r == over_s {
        return None;
    }
    let plane = b.plane();
    let [over_p, over_q] = [a.sites[1], a.sites[2]].map(|site| plane.side_of(site));
    if over_p == over_q {
        return None;
    }
    // The common line of the planes runs through the vertex and both opposite edges, or beyond them. Which of the edges
    // it meets first decides who is pierced: an edge pierces a face that it passes on the same side on its three sides,
    // of which two are known by now.
    let passes = side_of_plane(a.sites[1], a.sites[2], b.sites[1], b.sites[2]);
    match (passes == over_r, passes == over_p) {
        (true, false) => Some((a.edge_at(mesh, 1), b.face)),
        (false, true) => Some((b.edge_at(mesh, 1), a.face)),
        (false, false) => None,
        (true, true) => panic!("faces {} and {} have two crossings beside their vertex", a.face.0, b.face.0),
    }
}
