//! The charts of a path and of its corresponding path, and how far they reach.

use super::{
    charts::{Chart, ChartKind},
    lifted::LiftedPath,
    path_input::PathInput,
};
use crate::mesh::VertexId;

/// Width of the k-ring round a path and its region in the path's own chart.
const RINGS_ROUND_REGION: usize = 1;
/// A chart stops growing at this many faces; targets beyond it are moved to its outline.
const MAX_FACES: usize = 40_000;

/// Two charts, kept from one path to the next. The second path of a pair uses them exchanged, without moving them: so
/// that the next frame finds memory of the size that it needs.
#[derive(Debug, Default)]
pub(super) struct ChartPair {
    charts: [Chart; 2],
    is_exchanged: bool,
    is_one: bool,
}

impl ChartPair {
    /// Says whether the charts are to be used exchanged, and whether the own chart serves for both paths.
    pub(super) fn assign(&mut self, is_exchanged: bool, is_one: bool) {
        self.is_exchanged = is_exchanged;
        self.is_one = is_one;
    }

    fn own_index(&self) -> usize {
        usize::from(self.is_exchanged)
    }

    fn partner_index(&self) -> usize {
        if self.is_one { self.own_index() } else { 1 - self.own_index() }
    }

    /// The chart of the path.
    pub(super) fn own(&self) -> &Chart {
        &self.charts[self.own_index()]
    }

    /// The chart of the corresponding path.
    pub(super) fn partner(&self) -> &Chart {
        &self.charts[self.partner_index()]
    }

    /// The chart of the path.
    pub(super) fn own_mut(&mut self) -> &mut Chart {
        let index = self.own_index();
        &mut self.charts[index]
    }

    /// The chart of the corresponding path.
    pub(super) fn partner_mut(&mut self) -> &mut Chart {
        let index = self.partner_index();
        &mut self.charts[index]
    }

    /// Makes the chart of a path and its region; of both paths where they lie in one chart.
    pub(super) fn build_own(&mut self, input: &PathInput<'_>) -> Option<ChartKind> {
        let PathInput { mesh, frame, segments, .. } = *input;
        let patch = self.own_mut().patch_mut();
        patch.start(mesh, segments.iter().map(|segment| segment.own));
        if input.is_joint {
            patch.add_faces(mesh, segments.iter().map(|segment| segment.partner));
        }
        patch.add_stars(mesh, input.region);
        patch.grow(mesh, RINGS_ROUND_REGION, MAX_FACES);
        self.own_mut().build(mesh, frame)
    }

    /// Makes the chart of the corresponding path, where the targets lie: round its region, or else as far as the region
    /// of the path reaches from the path, which is lifted to `own_path`.
    pub(super) fn build_partner(&mut self, input: &PathInput<'_>, own_path: &LiftedPath) -> Option<ChartKind> {
        let PathInput { mesh, frame, segments, .. } = *input;
        let rings = match input.partner_region {
            Some(_) => RINGS_ROUND_REGION,
            None => depth_in_rings(input.region, self.own(), own_path, input.edge_length_m)
                .saturating_add(RINGS_ROUND_REGION + 1),
        };
        let patch = self.partner_mut().patch_mut();
        patch.start(mesh, segments.iter().map(|segment| segment.partner));
        patch.add_stars(mesh, input.partner_region.unwrap_or(&[]));
        patch.grow(mesh, rings, MAX_FACES);
        self.partner_mut().build(mesh, frame)
    }
}

/// The width of the k-ring of a path that holds its region, at 1.5 rings for each edge length.
fn depth_in_rings(region: &[VertexId], chart: &Chart, path: &LiftedPath, edge_length_m: f64) -> usize {
    let distances = region.iter().filter_map(|&vertex| Some(path.nearest_copy(chart, chart.vertex(vertex)?).1));
    let depth = distances.filter(|distance| distance.is_finite()).fold(0.0, f64::max);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the cast saturates, as it should")]
    let rings = (1.5 * depth / edge_length_m).ceil() as usize;
    rings
}
