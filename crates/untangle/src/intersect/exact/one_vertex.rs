//! Faces that have one vertex in common and nothing else: where they intersect beyond it.

use super::{
    contact::{Contact, Crossing},
    corners::Corners,
    directions::{DirectionBox, sort_directions},
};
use crate::{
    frame::Frame,
    intersect::bvh::MAX_ADJACENT_FACES,
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
    /// The directions of the faces, where there are many, in the order of the sweep.
    directions: Vec<DirectionBox>,
    /// The first face of the pairs that come next.
    next: usize,
}

/// What was done with a star.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct TestedStar {
    /// In the units of a share's work.
    pub(crate) work: usize,
    /// Pairs that came to exact signs, of a star of many faces.
    pub(crate) num_around: u64,
}

/// The work of testing one pair exactly, most of which end after two signs.
const PAIR_TEST: usize = 16;

impl VertexStar {
    /// Takes the faces around `vertex`.
    pub(crate) fn load(&mut self, mesh: &Mesh, frame: &Frame, vertex: VertexId) {
        self.clear();
        self.faces.extend(mesh.vertex_faces(vertex).iter().map(|&face| Corners::of(mesh, frame, face).from(vertex)));
        if self.faces.len() > MAX_ADJACENT_FACES {
            sort_directions(&self.faces, &mut self.directions);
        }
    }

    /// Forgets the faces.
    pub(crate) fn clear(&mut self) {
        self.faces.clear();
        self.directions.clear();
        self.next = 0;
    }

    /// Whether there are pairs left to test.
    pub(crate) fn is_loaded(&self) -> bool {
        self.next < self.faces.len()
    }

    /// Tests all pairs of faces that have the vertex in common and nothing else, and calls `found` with those that
    /// intersect beyond it, the lower face first. Of a star of many faces it ends once it has done the given work, and
    /// goes on when it is called again.
    ///
    /// Which pairs these are is known from the topology alone. Cost: quadratic in the faces around the vertex where
    /// they are few; where they are many, sort and sweep over the directions in which they lie (Cohen, Lin, Manocha and
    /// Ponamgi 1995), so that only those that overlap as seen from the vertex come to exact signs.
    pub(crate) fn test(
        &mut self,
        mesh: &Mesh,
        max_work: usize,
        found: &mut impl FnMut([FaceId; 2], Contact),
    ) -> TestedStar {
        let mut tested = TestedStar::default();
        let mut test = |a: &Corners, b: &Corners| {
            if let Some((edge, face)) = crossing(mesh, a, b) {
                found([a.face, b.face], Contact::FromLoopVertex((edge, face), a.vertices[0]));
            }
        };
        if self.directions.is_empty() {
            for (at, a) in self.faces.iter().enumerate() {
                self.faces[at + 1..].iter().for_each(|b| test(a, b));
                tested.work += PAIR_TEST * (self.faces.len() - at - 1);
            }
            self.next = self.faces.len();
        }
        while self.is_loaded() && tested.work < max_work {
            let a = &self.directions[self.next];
            for b in self.directions[self.next + 1..].iter().take_while(|b| b.min[0] <= a.max[0]) {
                tested.work += 1;
                if (1..3).all(|axis| a.min[axis] <= b.max[axis] && b.min[axis] <= a.max[axis]) {
                    tested.work += PAIR_TEST;
                    tested.num_around += 1;
                    let [first, second] = [a.at.min(b.at), a.at.max(b.at)];
                    test(&self.faces[first as usize], &self.faces[second as usize]);
                }
            }
            self.next += 1;
        }
        tested
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
