//! The two sheets of cloth that touch along a path.

use crate::mesh::FaceId;

use super::{PathPoint, PathSegment, SurfacePoint};

/// One of the two sheets of cloth that touch along a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sheet {
    /// Along the path.
    Own,
    /// Along the corresponding path.
    Partner,
}

impl Sheet {
    /// The place of a point of the path on this sheet.
    pub(crate) fn place(self, point: &PathPoint) -> &SurfacePoint {
        match self {
            Self::Own => &point.own,
            Self::Partner => &point.partner,
        }
    }

    /// The face of a segment on this sheet.
    pub(crate) fn face(self, segment: &PathSegment) -> FaceId {
        match self {
            Self::Own => segment.own,
            Self::Partner => segment.partner,
        }
    }
}
