//! All intersections of a frame: which edge pierces which face, and the segments between.
//!
//! The atom is the [`EdgeFaceIntersection`]: a mesh edge that pierces a face it shares no vertex with. Two faces that intersect
//! do so along one [`Segment`], between two of these or between one and a vertex that the faces share, the *loop vertex*.

mod arithmetic;
mod boxes;
mod broad;
mod coherence;
mod intersector;
pub(crate) mod lanes;
mod locate;
mod narrow;
mod neighbours;
mod rings;
mod search;
mod separate;
mod singles;
#[cfg(test)]
mod tests;
mod umbrella;
mod umbrellas;

use nalgebra::Point3;

use crate::mesh::{EdgeId, FaceId, VertexId};

pub use intersector::Intersector;
pub use narrow::do_intersect;

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
