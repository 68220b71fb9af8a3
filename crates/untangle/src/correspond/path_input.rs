//! A path whose correspondence is to be found, with all that is known of it beforehand.

use crate::{
    analysis::Analysis,
    frame::Frame,
    geometry::mean_edge_length,
    mesh::{Mesh, VertexId},
    paths::{PathCopy, PathPoint, PathSegment},
    settings::Settings,
};

/// One path copy of a frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct PathInput<'a> {
    pub(super) mesh: &'a Mesh,
    pub(super) frame: &'a Frame,
    pub(super) analysis: &'a Analysis,
    pub(super) settings: &'a Settings,
    /// Index of the path.
    pub(super) copy: usize,
    pub(super) path: &'a PathCopy,
    pub(super) points: &'a [PathPoint],
    pub(super) segments: &'a [PathSegment],
    /// The inside region of the path, sorted.
    pub(super) region: &'a [VertexId],
    /// The inside region of the corresponding path, where that one divides its piece.
    pub(super) partner_region: Option<&'a [VertexId]>,
    /// Whether both paths together bound one region: each vertex of it belongs to another one of it, as in a fold.
    pub(super) is_joint: bool,
    /// Mean edge length of the faces that the path runs through, in metres.
    pub(super) edge_length_m: f64,
}

impl<'a> PathInput<'a> {
    /// Looks a path up. Nothing where it is done together with its corresponding path, which comes first, or where all
    /// its faces are single points.
    pub(super) fn new(
        mesh: &'a Mesh,
        frame: &'a Frame,
        analysis: &'a Analysis,
        settings: &'a Settings,
        copy: usize,
    ) -> Option<Self> {
        let path = &analysis.paths.copies[copy];
        let points = &analysis.paths.points[path.points.clone()];
        let segments = &analysis.paths.segments[path.segments.clone()];
        let is_joint = analysis.regions.by_copy[copy].as_ref().is_some_and(|region| region.joint);
        if is_joint && path.partner < copy {
            return None;
        }
        let region = analysis.regions.vertices_of(copy);
        let partner_region = if is_joint {
            Some(region)
        } else {
            is_partitioning(analysis, path.partner).then(|| analysis.regions.vertices_of(path.partner))
        };
        let edge_length_m = mean_edge_length(mesh, frame, segments.iter().map(|segment| segment.own))?;
        Some(Self {
            mesh,
            frame,
            analysis,
            settings,
            copy,
            path,
            points,
            segments,
            region,
            partner_region,
            is_joint,
            edge_length_m,
        })
    }

    /// Whether path and corresponding path lie in one chart.
    pub(super) fn has_one_chart(&self) -> bool {
        self.path.partner == self.copy || self.is_joint
    }

    /// The part of the path's length that its separation constraints stand for, so that each length counts once: a pair
    /// with two regions has constraints for both of its paths.
    pub(super) fn share(&self) -> f64 {
        if self.partner_region.is_some() && !self.is_joint { 0.5 } else { 1.0 }
    }
}

/// Whether the region of a path divides its piece.
pub(super) fn is_partitioning(analysis: &Analysis, copy: usize) -> bool {
    analysis.regions.by_copy[copy].as_ref().is_some_and(|region| region.partitioning)
}
