//! What the search finds.

use nalgebra::Point3;

use crate::mesh::{EdgeId, FaceId, VertexId};

/// A mesh edge that pierces a face it shares no vertex with (EF).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeFaceIntersection {
    /// The edge that pierces.
    pub edge: EdgeId,
    /// The face that is pierced.
    pub face: FaceId,
    /// Position along the edge, 0 at its first vertex, 1 at its second.
    pub edge_parameter: f64,
    /// Barycentric coordinates in the face, one for each corner; they sum to 1.
    pub barycentric: [f64; 3],
    /// World position in metres.
    pub position: Point3<f64>,
}

/// Where a segment ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SegmentEnd {
    /// In an edge-face intersection, by its index in [`Intersections::edge_face`].
    EdgeFace(u32),
    /// In the vertex that the two faces share.
    LoopVertex(VertexId),
}

/// The intersection of two faces, a straight segment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Segment {
    /// The two faces, the lower index first.
    pub faces: [FaceId; 2],
    /// Its two ends; a loop vertex comes second.
    pub ends: [SegmentEnd; 2],
}

/// All intersections of one frame, in an order that depends on nothing but the mesh.
#[derive(Clone, Debug, Default)]
pub struct Intersections {
    /// Sorted by edge, then face.
    pub edge_face: Vec<EdgeFaceIntersection>,
    /// One for each intersecting pair of faces, sorted by the pair.
    pub segments: Vec<Segment>,
}

impl Intersections {
    /// Forgets all of them.
    pub(super) fn clear(&mut self) {
        self.edge_face.clear();
        self.segments.clear();
    }
}
