//! Edge-face tests of one pair of faces, with exact signs.
//!
//! On the perturbed input (see [`predicates`](crate::predicates)) faces without a common vertex have none or two edge-face
//! intersections, faces with one common vertex none or one, faces with a common edge none. There are no other cases.

use crate::{
    frame::Frame,
    mesh::{EdgeId, FaceId, Mesh, VertexId},
    predicates::{Side, Site, side_of_plane},
};

/// An edge and the face it pierces.
pub(crate) type Crossing = (EdgeId, FaceId);

/// How a pair of faces intersects.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Contact {
    /// Two edge-face intersections.
    Crossings([Crossing; 2]),
    /// One edge-face intersection and the common vertex.
    FromLoopVertex(Crossing, VertexId),
}

/// A face with all that the tests need.
struct Corners {
    face: FaceId,
    vertices: [VertexId; 3],
    sites: [Site; 3],
}

impl Corners {
    fn of(mesh: &Mesh, frame: &Frame, face: FaceId) -> Self {
        let vertices = mesh.face(face);
        Self { face, vertices, sites: vertices.map(|vertex| frame.site(vertex)) }
    }

    fn side_of(&self, site: Site) -> Side {
        let [a, b, c] = self.sites;
        side_of_plane(a, b, c, site)
    }

    /// Whether the line through `p` and `q`, which lie on different sides of this face, passes through it.
    fn is_pierced_by(&self, p: Site, q: Site) -> bool {
        let [a, b, c] = self.sites;
        let side = side_of_plane(p, q, a, b);
        side == side_of_plane(p, q, b, c) && side == side_of_plane(p, q, c, a)
    }
}

/// Tests one pair of usable faces.
///
/// Cost: a common edge is seen from the indices; most other pairs end after three signs.
pub(crate) fn contact(mesh: &Mesh, frame: &Frame, faces: [FaceId; 2]) -> Option<Contact> {
    // One order, so that nothing depends on how the pair was found.
    let [first, second] = if faces[0] < faces[1] { faces } else { [faces[1], faces[0]] };
    let (vertices, others) = (mesh.face(first), mesh.face(second));
    let mut shared = None;
    for (corner, vertex) in vertices.into_iter().enumerate() {
        if let Some(other) = others.iter().position(|&other| other == vertex) {
            if shared.is_some() {
                return None;
            }
            shared = Some((corner, other));
        }
    }
    let (a, b) = (Corners::of(mesh, frame, first), Corners::of(mesh, frame, second));
    match shared {
        None => apart(mesh, &a, &b),
        Some(corners) => around_vertex(mesh, &a, &b, corners),
    }
}

fn apart(mesh: &Mesh, a: &Corners, b: &Corners) -> Option<Contact> {
    let sides_b = b.sites.map(|site| a.side_of(site));
    if sides_b[0] == sides_b[1] && sides_b[1] == sides_b[2] {
        return None;
    }
    let sides_a = a.sites.map(|site| b.side_of(site));
    if sides_a[0] == sides_a[1] && sides_a[1] == sides_a[2] {
        return None;
    }
    let mut crossings = [None; 3];
    let mut num_crossings = 0;
    for (edges_of, sides, face) in [(a, sides_a, b), (b, sides_b, a)] {
        for corner in 0..3 {
            let next = (corner + 1) % 3;
            if sides[corner] != sides[next] && face.is_pierced_by(edges_of.sites[corner], edges_of.sites[next]) {
                assert!(num_crossings < 2, "faces {} and {} have three crossings", a.face.0, b.face.0);
                crossings[num_crossings] = Some((edge_at(mesh, edges_of, corner), face.face));
                num_crossings += 1;
            }
        }
    }
    match crossings {
        [Some(first), Some(second), _] => Some(Contact::Crossings([first, second])),
        [None, ..] => None,
        _ => panic!("faces {} and {} have one crossing: the signs are not consistent", a.face.0, b.face.0),
    }
}

fn around_vertex(mesh: &Mesh, a: &Corners, b: &Corners, shared: (usize, usize)) -> Option<Contact> {
    let mut crossing = None;
    for (edge_of, corner, face) in [(a, shared.0, b), (b, shared.1, a)] {
        let (near, far) = ((corner + 1) % 3, (corner + 2) % 3);
        let (p, q) = (edge_of.sites[near], edge_of.sites[far]);
        if face.side_of(p) != face.side_of(q) && face.is_pierced_by(p, q) {
            assert!(crossing.is_none(), "faces {} and {} have two crossings beside their vertex", a.face.0, b.face.0);
            crossing = Some((edge_at(mesh, edge_of, near), face.face));
        }
    }
    crossing.map(|crossing| Contact::FromLoopVertex(crossing, a.vertices[shared.0]))
}

fn edge_at(mesh: &Mesh, corners: &Corners, corner: usize) -> EdgeId {
    mesh.face_edges(corners.face).expect("the broad phase leaves ignored faces out")[corner]
}
