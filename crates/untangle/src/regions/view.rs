//! One frame as the search for inside regions sees it.

use crate::{
    frame::Frame,
    mesh::{EdgeId, FaceId, Mesh, VertexId},
    paths::{IntersectionPaths, PathCopy, PathPoint, PathSegment},
    settings::Settings,
};

/// What all decisions about the regions of one frame look at.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FrameView<'a> {
    pub(crate) mesh: &'a Mesh,
    pub(crate) frame: &'a Frame,
    pub(crate) paths: &'a IntersectionPaths,
    pub(crate) settings: &'a Settings,
}

impl<'a> FrameView<'a> {
    /// The points of a path.
    pub(crate) fn points_of(&self, copy: &PathCopy) -> &'a [PathPoint] {
        &self.paths.points[copy.points.clone()]
    }

    /// The segments of a path.
    pub(crate) fn segments_of(&self, copy: &PathCopy) -> &'a [PathSegment] {
        &self.paths.segments[copy.segments.clone()]
    }

    /// A third of the area of the faces round a vertex, in square metres.
    ///
    /// Half of each face is added with either of its two edges at the vertex, edge by edge. Edges are numbered by their
    /// vertices and a sum of two numbers has one value, so the order of the faces changes no bit and exact ties stay
    /// ties.
    pub(crate) fn vertex_area(&self, vertex: VertexId) -> f64 {
        let area = |face: &FaceId| {
            let mut corners = self.mesh.face(*face);
            corners.sort_unstable();
            let [a, b, c] = corners.map(|corner| self.frame.position(corner));
            (b - a).cross(&(c - a)).norm() / 12.0
        };
        let beside = |&edge: &EdgeId| self.mesh.edge_faces(edge).iter().map(area).sum::<f64>();
        self.mesh.vertex_edges(vertex).iter().map(beside).sum()
    }
}
