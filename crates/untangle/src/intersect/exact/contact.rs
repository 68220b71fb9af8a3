//! How a pair of faces intersects.

use crate::mesh::{EdgeId, FaceId, VertexId};

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
