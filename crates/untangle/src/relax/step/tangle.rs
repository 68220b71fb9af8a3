//! How tangled a state is, island by island.

use nalgebra::Point3;

use super::{
    islands::Islands,
    pinned::{are_faces_pinned, is_movable},
};
use crate::{
    frame::Frame,
    geometry::perimeter,
    intersect::{Intersections, SegmentEnd},
    mesh::{FaceId, Mesh},
};

/// How tangled something is: less is better.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Tangle {
    pub(crate) num_edge_face: usize,
    /// Length of the intersections, in edges of the faces that intersect.
    pub(crate) length_edges: f64,
    pub(crate) length_m: f64,
}

impl Tangle {
    /// Whether nothing intersects.
    pub(crate) fn is_none(&self) -> bool {
        self.num_edge_face == 0
    }

    /// The merit function of the line search: less is better.
    pub(crate) fn merit(&self) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "a count")]
        let count = self.num_edge_face as f64;
        count + 2.0 * self.length_edges
    }
}

/// Measures all intersections that a motion can change, island by island; the last entry is for those near no island.
pub(crate) fn measure(mesh: &Mesh, frame: &Frame, found: &Intersections, islands: &Islands, tangles: &mut Vec<Tangle>) {
    tangles.clear();
    tangles.resize(islands.len() + 1, Tangle::default());
    let island_of =
        |face: FaceId| mesh.face(face).into_iter().find_map(|vertex| islands.near(vertex)).unwrap_or(islands.len());
    for crossing in found.edge_face.iter().filter(|crossing| is_movable(mesh, crossing)) {
        tangles[island_of(crossing.face)].num_edge_face += 1;
    }
    for segment in found.segments.iter().filter(|segment| !are_faces_pinned(mesh, segment.faces)) {
        let [a, b] = segment.ends.map(|end| position(frame, found, end));
        let length = (b - a).norm();
        let edges = segment.faces.map(|face| perimeter(mesh.face(face).map(|vertex| frame.position(vertex))) / 3.0);
        let tangle = &mut tangles[island_of(segment.faces[0])];
        tangle.length_m += length;
        if edges[0] + edges[1] > 0.0 {
            tangle.length_edges += 2.0 * length / (edges[0] + edges[1]);
        }
    }
}

/// The sum over all islands.
pub(crate) fn total(tangles: &[Tangle]) -> Tangle {
    let mut sum = Tangle::default();
    for tangle in tangles {
        sum.num_edge_face += tangle.num_edge_face;
        sum.length_edges += tangle.length_edges;
        sum.length_m += tangle.length_m;
    }
    sum
}

fn position(frame: &Frame, found: &Intersections, end: SegmentEnd) -> Point3<f64> {
    match end {
        SegmentEnd::EdgeFace(index) => found.edge_face[index as usize].position,
        SegmentEnd::LoopVertex(vertex) => frame.position(vertex),
    }
}
