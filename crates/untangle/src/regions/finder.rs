//! From paths to their inside regions.

use super::{
    InsideRegion, InsideRegions,
    agreement::agreement,
    detours::BoundaryDetours,
    disc::Disc,
    flood::{FillRules, Flood, Partition},
    left_of_path::left_ends,
    side::SideChooser,
    starts_pair,
    view::FrameView,
};
use crate::{
    frame::Frame,
    mesh::{EdgeId, Mesh, VertexId},
    paths::{IntersectionPaths, PathCopy, PathPoint, PathType, SurfacePoint},
    settings::{InsideChoice, Settings},
    stage::StageObserver,
};

/// Finds inside regions, reusing its memory from frame to frame.
#[derive(Debug, Default)]
pub struct RegionFinder {
    flood: Flood,
    sides: SideChooser,
    disc: Disc,
    detours: BoundaryDetours,
    /// For each edge that a path crosses its place among the crossings and its end on the left, sorted.
    left: Vec<(EdgeId, usize, VertexId)>,
}

impl RegionFinder {
    /// Finds the inside regions of all paths of a frame, the longest pairs first, until the observer says that time is
    /// up.
    ///
    /// Cost: for each path linear in its segments and in the size of its smaller side; for BLI and BLB where texture
    /// coordinates are no smooth chart, O(n log n) in the faces of the disc.
    pub fn find(
        &mut self,
        mesh: &Mesh,
        frame: &Frame,
        paths: &IntersectionPaths,
        settings: &Settings,
        observer: &mut dyn StageObserver,
        regions: &mut InsideRegions,
    ) {
        let view = &FrameView { mesh, frame, paths, settings };
        regions.reset(paths);
        for place in 0..regions.order.len() {
            if starts_pair(paths, &regions.order, place) && observer.is_spent() {
                break;
            }
            let index = regions.order[place];
            let copy = &paths.copies[index];
            let region = match copy.path_type {
                PathType::Closed | PathType::LoopLoop | PathType::BoundaryBoundary => {
                    Some(self.partition(view, index, false, regions))
                }
                PathType::BoundaryLoopInside | PathType::BoundaryLoopBoundary => {
                    Some(self.partition_disc(view, copy, regions))
                }
                PathType::BoundaryInside | PathType::InsideInside => None,
            };
            regions.by_copy[index] = region;
            self.partition_jointly(view, index, regions);
            self.make_insides_agree(view, index, regions);
            regions.num_done = place + 1;
        }
    }

    /// Finds the region between two corresponding paths of which neither separates alone, but both together do: two
    /// paths that join both boundaries of a tube. An end a little way inside of a boundary, where the boundary of the
    /// other sheet pierces the cloth, counts as one on the boundary.
    fn partition_jointly(&mut self, view: &FrameView<'_>, second: usize, regions: &mut InsideRegions) {
        let first = view.paths.copies[second].partner;
        if first >= second || view.paths.copies[second].closed {
            return;
        }
        let both = [first, second];
        if both.iter().any(|&copy| regions.by_copy[copy].as_ref().is_some_and(|region| region.partitioning)) {
            return;
        }
        if !self.detours.join_two_boundaries(view, both) {
            return;
        }
        self.flood.reset(view.mesh);
        for (index, copy) in both.into_iter().enumerate() {
            self.cross_edges(view.paths, &view.paths.copies[copy]);
            self.detours.edges(index).for_each(|edge| self.flood.cross(edge));
        }
        let points = view.points_of(&view.paths.copies[first]);
        let region =
            fill_inside((&mut self.flood, &mut self.sides), view, points, &|_| true, &|_| None, false, regions);
        if region.partitioning {
            regions.by_copy[first] = Some(InsideRegion { joint: true, ..region });
            regions.by_copy[second] = Some(InsideRegion { partitioning: true, joint: true, ..InsideRegion::default() });
        }
    }

    /// Makes the insides of two closed paths agree: where their sheets run side by side rather than across each other,
    /// the insides have to lie on the same side, of two tubes that run into each other both upper ends, or both lower
    /// ones. Where the smaller sides say otherwise, the smallest pair of sides that agrees is taken.
    fn make_insides_agree(&mut self, view: &FrameView<'_>, second: usize, regions: &mut InsideRegions) {
        let first = view.paths.copies[second].partner;
        // The paper's rule, by count, stays as the paper has it; winding numbers, where switched on, decide better.
        let decided =
            view.settings.winding || view.settings.inside == InsideChoice::Count || !view.paths.copies[second].closed;
        if first >= second || decided || agreement(view, first, regions) >= -0.5 {
            return;
        }
        let both = [first, second];
        let kept = both.map(|copy| regions.vertices_of(copy).len());
        let start = regions.by_copy[first].as_ref().map_or(0, |region| region.vertices.start);
        let mut other = [0; 2];
        for (copy, count) in both.into_iter().zip(&mut other) {
            regions.vertices.truncate(start);
            *count = self.partition(view, copy, true, regions).vertices.len();
        }
        regions.vertices.truncate(start);
        let flipped = usize::from(kept[0] + other[1] < kept[1] + other[0]);
        for (index, copy) in both.into_iter().enumerate() {
            let region = self.partition(view, copy, index == flipped, regions);
            regions.by_copy[copy] = Some(region);
        }
    }

    /// The inside of one path, or, with `opposite`, the side that would not be chosen.
    fn partition(
        &mut self,
        view: &FrameView<'_>,
        copy: usize,
        opposite: bool,
        regions: &mut InsideRegions,
    ) -> InsideRegion {
        self.flood.reset(view.mesh);
        self.cross_edges(view.paths, &view.paths.copies[copy]);
        let points = view.points_of(&view.paths.copies[copy]);
        fill_inside((&mut self.flood, &mut self.sides), view, points, &|_| true, &|_| None, opposite, regions)
    }

    /// The inside of the disc round the loop vertex of a BLI path.
    fn partition_disc(&mut self, view: &FrameView<'_>, copy: &PathCopy, regions: &mut InsideRegions) -> InsideRegion {
        let points = view.points_of(copy);
        let loop_vertices = &view.paths.pairs[copy.pair].loop_vertices;
        let segments = view.segments_of(copy);
        let passed = segments.windows(2).zip(&points[1..]).find_map(|(run, point)| match point.own {
            SurfacePoint::Vertex(vertex) if loop_vertices.contains(&vertex) => Some((vertex, [run[0].own, run[1].own])),
            _ => None,
        });
        let (Some((centre, around)), Some(first), Some(last)) = (passed, points.first(), points.last()) else {
            return InsideRegion::default();
        };
        let ends = [first.own, last.own];
        let Some(radius) = self.disc.build(view.mesh, view.frame, centre, around, ends) else {
            return InsideRegion::default();
        };
        self.flood.reset(view.mesh);
        self.cross_edges(view.paths, copy);
        left_ends(view.mesh, points, segments, &mut self.left);
        let (disc, left) = (&self.disc, &self.left);
        let left = |edge| left.binary_search_by_key(&edge, |&(edge, ..)| edge).ok().map(|at| left[at].2);
        let allowed = |vertex| disc.contains(view.mesh, vertex);
        let region = fill_inside((&mut self.flood, &mut self.sides), view, points, &allowed, &left, false, regions);
        InsideRegion { disc_radius: Some(radius), ..region }
    }

    /// Notes in the fill which edges a path crosses. The boundary edge in which it ends counts: without it no BB path
    /// separates.
    fn cross_edges(&mut self, paths: &IntersectionPaths, copy: &PathCopy) {
        let points = &paths.points[copy.points.clone()];
        // A closed path repeats its first point at the end.
        let points = if copy.closed { &points[..points.len() - 1] } else { points };
        for point in points {
            match point.own {
                SurfacePoint::Edge { edge, .. } => self.flood.cross(edge),
                SurfacePoint::Vertex(vertex) => self.flood.remove(vertex),
                SurfacePoint::Face { .. } => {}
            }
        }
    }
}

/// Fills both sides of the path whose crossings `flood` holds, and keeps the inside or, with `opposite`, the other
/// side.
fn fill_inside(
    (flood, sides): (&mut Flood, &mut SideChooser),
    view: &FrameView<'_>,
    points: &[PathPoint],
    allowed: &dyn Fn(VertexId) -> bool,
    left: &dyn Fn(EdgeId) -> Option<VertexId>,
    opposite: bool,
    regions: &mut InsideRegions,
) -> InsideRegion {
    let (count, area) = (|_| 1.0, |vertex| view.vertex_area(vertex));
    let rules = match view.settings.inside {
        InsideChoice::Count | InsideChoice::Work => FillRules { allowed, weight: &count, tie_weight: &area, left },
        InsideChoice::Area => FillRules { allowed, weight: &area, tie_weight: &count, left },
    };
    let first = regions.vertices.len();
    let partitioning = flood.fill(view.mesh, &rules) == Partition::TwoSides;
    if partitioning {
        let mut inside = sides.choose(flood, view, points, &rules);
        if opposite {
            inside = 1 - inside;
            flood.complete(view.mesh, &rules);
        }
        regions.vertices.extend_from_slice(flood.side(inside));
    }
    InsideRegion { partitioning, vertices: first..regions.vertices.len(), ..InsideRegion::default() }
}
