//! How tangled a state is, island by island.

use std::ops::AddAssign;

use nalgebra::Point3;

use super::{
    islands::Islands,
    pinned::{are_faces_pinned, is_movable},
};
use crate::{
    frame::Frame,
    geometry::perimeter,
    intersect::{Intersections, Segment, SegmentEnd},
    mesh::{FaceId, Mesh, VertexId},
    relax::sides::{SideTracker, Wrong},
};

/// What the depth of a vertex inside of a body, in edges, counts for beside an edge-face intersection.
const DEPTH_WEIGHT: f64 = 0.25;

/// How tangled something is: less is better.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Tangle {
    pub(crate) num_edge_face: usize,
    /// Length of the intersections, in edges of the faces that intersect.
    pub(crate) length_edges: f64,
    pub(crate) length_m: f64,
    /// Free vertices on the wrong side: inside of a body, or behind an inner layer.
    pub(crate) num_wrong: usize,
    /// The sum of their depths, in edges.
    pub(crate) depth_edges: f64,
}

impl Tangle {
    /// Whether nothing intersects, and no vertex is inside of a body.
    pub(crate) fn is_none(&self) -> bool {
        self.num_edge_face == 0 && self.num_wrong == 0
    }

    /// The merit function of the line search: less is better.
    pub(crate) fn merit(&self) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "counts")]
        let [count, wrong] = [self.num_edge_face, self.num_wrong].map(|count| count as f64);
        count + 2.0 * self.length_edges + wrong + DEPTH_WEIGHT * self.depth_edges
    }
}

impl AddAssign for Tangle {
    fn add_assign(&mut self, other: Self) {
        self.num_edge_face += other.num_edge_face;
        self.length_edges += other.length_edges;
        self.length_m += other.length_m;
        self.num_wrong += other.num_wrong;
        self.depth_edges += other.depth_edges;
    }
}

/// Measures all intersections that a motion can change, and what is inside of bodies, island by island; the last entry
/// is for those near no island.
pub(crate) fn measure(
    mesh: &Mesh,
    frame: &Frame,
    found: &Intersections,
    sides: Option<&SideTracker>,
    islands: &Islands,
    tangles: &mut Vec<Tangle>,
) {
    tangles.clear();
    tangles.resize(islands.len() + 1, Tangle::default());
    let island_of =
        |face: FaceId| mesh.face(face).into_iter().find_map(|vertex| islands.near(vertex)).unwrap_or(islands.len());
    for crossing in found.edge_face.iter().filter(|crossing| is_movable(mesh, crossing)) {
        let island = if mesh.is_body_face(crossing.face) {
            mesh.edge(crossing.edge).into_iter().find_map(|end| islands.near(end)).unwrap_or(islands.len())
        } else {
            island_of(crossing.face)
        };
        tangles[island].num_edge_face += 1;
    }
    for segment in found.segments.iter().filter(|segment| !are_faces_pinned(mesh, segment.faces)) {
        let [first, second] = segment.faces;
        let tangle = &mut tangles[island_of(if mesh.is_body_face(first) { second } else { first })];
        let (length_m, length_edges) = lengths(mesh, frame, found, segment);
        tangle.length_m += length_m;
        tangle.length_edges += length_edges;
    }
    for Wrong { vertex, way, edge_m, .. } in
        sides.map(|sides| sides.wrong(mesh, frame.positions())).into_iter().flatten()
    {
        let tangle = &mut tangles[islands.of(vertex)];
        tangle.num_wrong += 1;
        tangle.depth_edges += if edge_m > 0.0 { way.depth_m / edge_m } else { 0.0 };
    }
}

/// Measures all intersections that a motion can change as [`measure`] does, but counts each for every island that it
/// touches by a vertex, and in `all` once.
pub(crate) fn measure_touched(
    mesh: &Mesh,
    frame: &Frame,
    found: &Intersections,
    islands: &Islands,
    tangles: &mut Vec<Tangle>,
    all: &mut Tangle,
) {
    tangles.clear();
    tangles.resize(islands.len() + 1, Tangle::default());
    *all = Tangle::default();
    let mut count = |vertices: &[VertexId], part: Tangle| {
        *all += part;
        for (index, &vertex) in vertices.iter().enumerate() {
            let island = islands.of(vertex);
            if vertices[..index].iter().all(|&other| islands.of(other) != island) {
                tangles[island] += part;
            }
        }
    };
    for crossing in found.edge_face.iter().filter(|crossing| is_movable(mesh, crossing)) {
        let ([a, b], [c, d, e]) = (mesh.edge(crossing.edge), mesh.face(crossing.face));
        count(&[a, b, c, d, e], Tangle { num_edge_face: 1, ..Tangle::default() });
    }
    for segment in found.segments.iter().filter(|segment| !are_faces_pinned(mesh, segment.faces)) {
        let (length_m, length_edges) = lengths(mesh, frame, found, segment);
        let [[a, b, c], [d, e, f]] = segment.faces.map(|face| mesh.face(face));
        count(&[a, b, c, d, e, f], Tangle { length_edges, length_m, ..Tangle::default() });
    }
}

/// The length of a segment in metres, and in edges of the two faces.
fn lengths(mesh: &Mesh, frame: &Frame, found: &Intersections, segment: &Segment) -> (f64, f64) {
    let [a, b] = segment.ends.map(|end| position(frame, found, end));
    let length_m = (b - a).norm();
    let edges = segment.faces.map(|face| perimeter(mesh.face(face).map(|vertex| frame.position(vertex))) / 3.0);
    let sum = edges[0] + edges[1];
    (length_m, if sum > 0.0 { 2.0 * length_m / sum } else { 0.0 })
}

/// The sum over all islands.
pub(crate) fn total(tangles: &[Tangle]) -> Tangle {
    let mut sum = Tangle::default();
    for tangle in tangles {
        sum += *tangle;
    }
    sum
}

fn position(frame: &Frame, found: &Intersections, end: SegmentEnd) -> Point3<f64> {
    match end {
        SegmentEnd::EdgeFace(index) => found.edge_face[index as usize].position,
        SegmentEnd::LoopVertex(vertex) => frame.position(vertex),
    }
}
