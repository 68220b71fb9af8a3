//! Edge-face tests of one pair of faces, with exact signs.
//!
//! On the perturbed input (see [`predicates`](crate::predicates)) faces without a common vertex have none or two edge-face
//! intersections, faces with one common vertex none or one, faces with a common edge none. There are no other cases.

use super::separate::are_apart;
use crate::{
    frame::Frame,
    mesh::{EdgeId, FaceId, Mesh, VertexId},
    predicates::{Plane, Side, Site, side_of_plane},
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
#[derive(Debug)]
struct Corners {
    face: FaceId,
    /// The corner of the mesh's face that stands first here.
    first: usize,
    vertices: [VertexId; 3],
    sites: [Site; 3],
}

impl Corners {
    fn of(mesh: &Mesh, frame: &Frame, face: FaceId) -> Self {
        let vertices = mesh.face(face);
        let [a, b, c] = vertices;
        Self { face, first: 0, vertices, sites: [frame.site(a), frame.site(b), frame.site(c)] }
    }

    /// The same face with its corners turned round so that `vertex` stands first.
    fn from(mut self, vertex: VertexId) -> Self {
        self.first = self.vertices.iter().position(|&corner| corner == vertex).unwrap_or_default();
        self.vertices.rotate_left(self.first);
        self.sites.rotate_left(self.first);
        self
    }

    fn plane(&self) -> Plane {
        Plane::through(self.sites)
    }

    /// The sides of a plane on which the corners lie.
    #[inline]
    fn sides_of(&self, plane: &Plane) -> [Side; 3] {
        let [a, b, c] = self.sites;
        [plane.side_of(a), plane.side_of(b), plane.side_of(c)]
    }
}

/// The first vertex that two faces have in common.
fn common_vertex(mesh: &Mesh, [a, b]: [FaceId; 2]) -> Option<VertexId> {
    let others = mesh.face(b);
    mesh.face(a).into_iter().find(|vertex| others.contains(vertex))
}

/// Whether two faces have a vertex in common.
pub(crate) fn share_a_vertex(mesh: &Mesh, faces: [FaceId; 2]) -> bool {
    common_vertex(mesh, faces).is_some()
}

/// Whether two faces intersect: along a segment, beyond what they have in common. Ignored faces intersect nothing.
///
/// For those who find pairs of faces by themselves; [`Intersector`](super::Intersector) finds all pairs of a frame faster.
#[must_use]
pub fn do_intersect(mesh: &Mesh, frame: &Frame, faces: [FaceId; 2]) -> bool {
    if faces[0] == faces[1] || faces.iter().any(|&face| mesh.face_edges(face).is_none()) {
        return false;
    }
    if let Some(vertex) = common_vertex(mesh, faces) {
        return contact_beyond(mesh, frame, faces, vertex).is_some();
    }
    let [a, b] = faces.map(|face| mesh.face(face).map(|corner| frame.position(corner).into()));
    !are_apart(&a, &b) && contact(mesh, frame, faces).is_some()
}

/// Tests one pair of usable faces without a common vertex.
///
/// Cost: most pairs end after three signs.
// Out of the way of the loops that call it now and then, and are to be inlined whole.
#[inline(never)]
pub(crate) fn contact(mesh: &Mesh, frame: &Frame, faces: [FaceId; 2]) -> Option<Contact> {
    // One order, so that nothing depends on how the pair was found.
    let [first, second] = if faces[0] < faces[1] { faces } else { [faces[1], faces[0]] };
    let (a, b) = (Corners::of(mesh, frame, first), Corners::of(mesh, frame, second));
    apart(mesh, &a, &b)
}

/// Tests one pair of usable faces that have one vertex in common and nothing else.
pub(crate) fn contact_beyond(mesh: &Mesh, frame: &Frame, faces: [FaceId; 2], vertex: VertexId) -> Option<Contact> {
    let [a, b] = faces.map(|face| Corners::of(mesh, frame, face).from(vertex));
    beyond_vertex(mesh, &a, &b).map(|crossing| Contact::FromLoopVertex(crossing, vertex))
}

fn apart(mesh: &Mesh, a: &Corners, b: &Corners) -> Option<Contact> {
    let sides_b = b.sides_of(&a.plane());
    if sides_b[0] == sides_b[1] && sides_b[1] == sides_b[2] {
        return None;
    }
    let sides_a = a.sides_of(&b.plane());
    if sides_a[0] == sides_a[1] && sides_a[1] == sides_a[2] {
        return None;
    }
    // Each face crosses the other's plane along two edges, those of the corner that lies alone. All four pierce the common line of the planes;
    // on which side of one of them another one passes says in which order, and so which lie within the other face.
    let (alone_a, alone_b) = (alone(sides_a), alone(sides_b));
    let from_a = |step: usize| a.sites[(alone_a + step) % 3];
    let from_b = |step: usize| b.sites[(alone_b + step) % 3];
    // Of an edge of a from its corner p to q and one of b from r to s: the side of the plane (p, q, r) of s is that of (p, r, s) of q.
    let first = Plane::through([from_a(0), from_b(0), from_b(1)]);
    let second = Plane::through([from_a(0), from_b(0), from_b(2)]);
    let (aa, ab) = (first.side_of(from_a(1)), second.side_of(from_a(1)));
    let (ba, bb) = (first.side_of(from_a(2)), second.side_of(from_a(2)));
    let edge_from = |of: &Corners, corner: usize, step: usize| edge_at(mesh, of, (corner + 2 * (step - 1)) % 3);
    let mut crossings = [None; 2];
    let mut num_crossings = 0;
    for (is_crossing, of, corner, step, face) in [
        (aa != ab, a, alone_a, 1, b),
        (ba != bb, a, alone_a, 2, b),
        (aa != ba, b, alone_b, 1, a),
        (ab != bb, b, alone_b, 2, a),
    ] {
        if is_crossing {
            assert!(num_crossings < 2, "faces {} and {} have three crossings", a.face.0, b.face.0);
            crossings[num_crossings] = Some((edge_from(of, corner, step), face.face));
            num_crossings += 1;
        }
    }
    match crossings {
        [Some(first), Some(second)] => Some(Contact::Crossings([first, second])),
        [None, _] => None,
        _ => panic!("faces {} and {} have one crossing: the signs are not consistent", a.face.0, b.face.0),
    }
}

/// The corner on the other side than the two others, where not all lie on one.
fn alone([a, b, c]: [Side; 3]) -> usize {
    if b == c {
        0
    } else if a == c {
        1
    } else {
        2
    }
}

/// The faces round one vertex, tested pair by pair, reusing its memory from vertex to vertex.
#[derive(Debug, Default)]
pub(crate) struct Fan {
    /// Each starts at the vertex.
    faces: Vec<Corners>,
}

impl Fan {
    /// Tests all pairs of faces that have `vertex` in common and nothing else, and calls `found` with those that intersect beyond it,
    /// the lower face first.
    ///
    /// Which pairs these are is known from the topology alone. Cost: quadratic in the faces round the vertex; most pairs end after two
    /// signs.
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
                if let Some(crossing) = beyond_vertex(mesh, a, b) {
                    found([a.face, b.face], Contact::FromLoopVertex(crossing, vertex));
                }
            }
        }
    }
}

/// Where one of two faces that start at their common vertex is pierced by the other's opposite edge.
fn beyond_vertex(mesh: &Mesh, a: &Corners, b: &Corners) -> Option<Crossing> {
    let ([_, p, q], [_, r, s]) = (a.vertices, b.vertices);
    if p == r || p == s || q == r || q == s {
        return None;
    }
    // A face that lies on one side of the other's plane, but for the common vertex, can't reach it.
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
    // The common line of the planes runs through the vertex and both opposite edges, or beyond them. Which of the edges it meets first decides
    // who is pierced: an edge pierces a face that it passes on the same side on its three sides, of which two are known by now.
    let passes = side_of_plane(a.sites[1], a.sites[2], b.sites[1], b.sites[2]);
    match (passes == over_r, passes == over_p) {
        (true, false) => Some((edge_at(mesh, a, 1), b.face)),
        (false, true) => Some((edge_at(mesh, b, 1), a.face)),
        (false, false) => None,
        (true, true) => panic!("faces {} and {} have two crossings beside their vertex", a.face.0, b.face.0),
    }
}

/// The edge from a corner to the next.
fn edge_at(mesh: &Mesh, corners: &Corners, corner: usize) -> EdgeId {
    let edges = mesh.face_edges(corners.face).expect("ignored faces are never tested");
    edges[(corner + corners.first) % 3]
}
