//! From paths to their inside regions.

use super::{
    InsideRegion, InsideRegions,
    disc::Disc,
    flood::{Flood, Separation, Terms},
    side::{Scene, choose_side},
    starts_pair,
};
use crate::{
    analysis::StageObserver,
    frame::Frame,
    mesh::{EdgeId, FaceId, Mesh, VertexId},
    paths::{IntersectionPaths, PathCopy, PathPoint, PathType, SurfacePoint},
    settings::{InsideChoice, Settings},
};

/// Finds inside regions, reusing its memory from frame to frame.
#[derive(Debug, Default)]
pub struct RegionFinder {
    flood: Flood,
    disc: Disc,
}

impl RegionFinder {
    /// Finds the inside regions of all paths of a frame, the longest pairs first, until the observer says that time is up.
    ///
    /// Cost: for each path linear in its segments and in the size of its smaller side; for BLI and BLB in the faces of the disc.
    pub fn find(
        &mut self,
        mesh: &Mesh,
        frame: &Frame,
        paths: &IntersectionPaths,
        settings: &Settings,
        observer: &mut dyn StageObserver,
        regions: &mut InsideRegions,
    ) {
        let scene = &Scene { mesh, frame, paths, settings };
        regions.start(paths);
        for place in 0..regions.order.len() {
            if starts_pair(paths, &regions.order, place) && observer.is_spent() {
                break;
            }
            let index = regions.order[place];
            let copy = &paths.copies[index];
            let region = match copy.path_type {
                PathType::Closed | PathType::LoopLoop | PathType::BoundaryBoundary => {
                    Some(self.partition(scene, &[index], regions))
                }
                PathType::BoundaryLoopInside | PathType::BoundaryLoopBoundary => {
                    Some(self.cut_disc(scene, copy, regions))
                }
                PathType::BoundaryInside | PathType::InsideInside => None,
            };
            regions.by_copy[index] = region;
            self.join_copies(scene, index, regions);
            regions.num_done = place + 1;
        }
    }

    /// Where neither of two corresponding paths separates, both together may: two hem-to-hem paths on a tube.
    fn join_copies(&mut self, scene: &Scene<'_>, second: usize, regions: &mut InsideRegions) {
        let first = scene.paths.copies[second].partner;
        let fails = |copy: usize| regions.by_copy[copy].as_ref().is_some_and(|region| !region.partitioning);
        if first < second && fails(first) && fails(second) {
            let region = self.partition(scene, &[first, second], regions);
            if region.partitioning {
                let empty = InsideRegion { partitioning: true, ..InsideRegion::default() };
                regions.by_copy[second] = Some(empty);
            }
            regions.by_copy[first] = Some(region);
        }
    }

    /// The inside of one path, or of several together.
    fn partition(&mut self, scene: &Scene<'_>, copies: &[usize], regions: &mut InsideRegions) -> InsideRegion {
        self.flood.begin(scene.mesh);
        for &copy in copies {
            self.cross_edges(scene.paths, &scene.paths.copies[copy]);
        }
        let points = &scene.paths.points[scene.paths.copies[copies[0]].points.clone()];
        divide(&mut self.flood, scene, points, &|_| true, &|_| None, regions)
    }

    /// The inside of the disc round the loop vertex of a BLI path.
    fn cut_disc(&mut self, scene: &Scene<'_>, copy: &PathCopy, regions: &mut InsideRegions) -> InsideRegion {
        let points = &scene.paths.points[copy.points.clone()];
        let loop_vertices = &scene.paths.pairs[copy.pair].loop_vertices;
        let centre = points.iter().find_map(|point| match point.own {
            SurfacePoint::Vertex(vertex) if loop_vertices.contains(&vertex) => Some(vertex),
            _ => None,
        });
        let (Some(centre), Some(first), Some(last)) = (centre, points.first(), points.last()) else {
            return InsideRegion::default();
        };
        let Some(radius) = self.disc.unfold(scene.mesh, scene.frame, centre, [first.own, last.own]) else {
            return InsideRegion::default();
        };
        self.flood.begin(scene.mesh);
        self.cross_edges(scene.paths, copy);
        let disc = &self.disc;
        let left = |edge| disc.left_end(scene.mesh, points, edge);
        let region = divide(&mut self.flood, scene, points, &|vertex| disc.contains(vertex), &left, regions);
        InsideRegion { disc_radius: Some(radius), ..region }
    }

    /// Tells the fill which edges a path crosses. The boundary edge in which it ends counts: without it no BB path separates.
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

/// Fills both sides of the path that `flood` was told, and notes the inside.
fn divide(
    flood: &mut Flood,
    scene: &Scene<'_>,
    points: &[PathPoint],
    allowed: &dyn Fn(VertexId) -> bool,
    left: &dyn Fn(EdgeId) -> Option<VertexId>,
    regions: &mut InsideRegions,
) -> InsideRegion {
    let (count, area) = (|_| 1.0, |vertex| vertex_area(scene, vertex));
    let terms = match scene.settings.inside {
        InsideChoice::Count | InsideChoice::Work => Terms { allowed, weight: &count, tie_weight: &area, left },
        InsideChoice::Area => Terms { allowed, weight: &area, tie_weight: &count, left },
    };
    let first = regions.vertices.len();
    let partitioning = flood.fill(scene.mesh, &terms) == Separation::Two;
    if partitioning {
        let inside = choose_side(flood, scene, points, &terms);
        regions.vertices.extend_from_slice(flood.side(inside));
    }
    InsideRegion { partitioning, vertices: first..regions.vertices.len(), disc_radius: None }
}

/// A third of the area of the faces round a vertex, in square metres.
pub(crate) fn vertex_area(scene: &Scene<'_>, vertex: VertexId) -> f64 {
    let area = |face: &FaceId| {
        let [a, b, c] = scene.mesh.face(*face).map(|corner| scene.frame.position(corner));
        (b - a).cross(&(c - a)).norm() / 6.0
    };
    scene.mesh.vertex_faces(vertex).iter().map(area).sum()
}
