//! From paths to their inside regions.

use super::{
    InsideRegion, InsideRegions,
    disc::Disc,
    flood::{Flood, Separation, Terms},
    left::left_ends,
    pair::{Shore, agreement},
    side::{Scene, choose_side},
    starts_pair,
};
use crate::{
    frame::Frame,
    mesh::{EdgeId, FaceId, Mesh, VertexId},
    paths::{IntersectionPaths, PathCopy, PathPoint, PathType, SurfacePoint},
    settings::{InsideChoice, Settings},
    stage::StageObserver,
};

/// Finds inside regions, reusing its memory from frame to frame.
#[derive(Debug, Default)]
pub struct RegionFinder {
    flood: Flood,
    disc: Disc,
    shore: Shore,
    /// For each edge that a path crosses its place among them and the end on the left, sorted.
    left: Vec<(EdgeId, usize, VertexId)>,
}

impl RegionFinder {
    /// Finds the inside regions of all paths of a frame, the longest pairs first, until the observer says that time is up.
    ///
    /// Cost: for each path linear in its segments and in the size of its smaller side; for BLI and BLB where texture coordinates are no
    /// smooth chart, O(n log n) in the faces of the disc.
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
                    Some(self.partition(scene, index, false, regions))
                }
                PathType::BoundaryLoopInside | PathType::BoundaryLoopBoundary => {
                    Some(self.cut_disc(scene, copy, regions))
                }
                PathType::BoundaryInside | PathType::InsideInside => None,
            };
            regions.by_copy[index] = region;
            self.join_copies(scene, index, regions);
            self.agree(scene, index, regions);
            regions.num_done = place + 1;
        }
    }

    /// Where neither of two corresponding paths separates, both together may: two paths from hem to hem of a tube. An end a little way
    /// inside of the hem, where the other sheet's hem pierces the cloth, counts as one on the hem.
    fn join_copies(&mut self, scene: &Scene<'_>, second: usize, regions: &mut InsideRegions) {
        let first = scene.paths.copies[second].partner;
        if first >= second || scene.paths.copies[second].closed {
            return;
        }
        let both = [first, second];
        if both.iter().any(|&copy| regions.by_copy[copy].as_ref().is_some_and(|region| region.partitioning)) {
            return;
        }
        if !self.shore.reach(scene, both) {
            return;
        }
        self.flood.begin(scene.mesh);
        for (index, copy) in both.into_iter().enumerate() {
            self.cross_edges(scene.paths, &scene.paths.copies[copy]);
            self.shore.edges(index).for_each(|edge| self.flood.cross(edge));
        }
        let points = &scene.paths.points[scene.paths.copies[first].points.clone()];
        let region = divide(&mut self.flood, scene, points, &|_| true, &|_| None, false, regions);
        if region.partitioning {
            regions.by_copy[first] = Some(InsideRegion { joint: true, ..region });
            regions.by_copy[second] = Some(InsideRegion { partitioning: true, joint: true, ..InsideRegion::default() });
        }
    }

    /// Two closed paths whose sheets run side by side rather than across each other have their insides on the same side: of two tubes
    /// that run into each other both upper ends, or both lower ones. Where the smaller sides say otherwise, the smallest pair that agrees counts.
    fn agree(&mut self, scene: &Scene<'_>, second: usize, regions: &mut InsideRegions) {
        let first = scene.paths.copies[second].partner;
        // The count stays as it is printed, and winding numbers, where they are asked for, know better.
        let decided = scene.settings.winding
            || scene.settings.inside == InsideChoice::Count
            || !scene.paths.copies[second].closed;
        if first >= second || decided || agreement(scene, first, regions) >= -0.5 {
            return;
        }
        let both = [first, second];
        let kept = both.map(|copy| regions.vertices_of(copy).len());
        let start = regions.by_copy[first].as_ref().map_or(0, |region| region.vertices.start);
        let mut other = [0; 2];
        for (copy, count) in both.into_iter().zip(&mut other) {
            regions.vertices.truncate(start);
            *count = self.partition(scene, copy, true, regions).vertices.len();
        }
        regions.vertices.truncate(start);
        let turned = usize::from(kept[0] + other[1] < kept[1] + other[0]);
        for (index, copy) in both.into_iter().enumerate() {
            let region = self.partition(scene, copy, index == turned, regions);
            regions.by_copy[copy] = Some(region);
        }
    }

    /// The inside of one path; with `turned` the side that it would not choose.
    fn partition(&mut self, scene: &Scene<'_>, copy: usize, turned: bool, regions: &mut InsideRegions) -> InsideRegion {
        self.flood.begin(scene.mesh);
        self.cross_edges(scene.paths, &scene.paths.copies[copy]);
        let points = &scene.paths.points[scene.paths.copies[copy].points.clone()];
        divide(&mut self.flood, scene, points, &|_| true, &|_| None, turned, regions)
    }

    /// The inside of the disc round the loop vertex of a BLI path.
    fn cut_disc(&mut self, scene: &Scene<'_>, copy: &PathCopy, regions: &mut InsideRegions) -> InsideRegion {
        let points = &scene.paths.points[copy.points.clone()];
        let loop_vertices = &scene.paths.pairs[copy.pair].loop_vertices;
        let segments = &scene.paths.segments[copy.segments.clone()];
        let passed = segments.windows(2).zip(&points[1..]).find_map(|(run, point)| match point.own {
            SurfacePoint::Vertex(vertex) if loop_vertices.contains(&vertex) => Some((vertex, [run[0].own, run[1].own])),
            _ => None,
        });
        let (Some((centre, around)), Some(first), Some(last)) = (passed, points.first(), points.last()) else {
            return InsideRegion::default();
        };
        let ends = [first.own, last.own];
        let Some(radius) = self.disc.reach(scene.mesh, scene.frame, centre, around, ends) else {
            return InsideRegion::default();
        };
        self.flood.begin(scene.mesh);
        self.cross_edges(scene.paths, copy);
        left_ends(scene.mesh, points, segments, &mut self.left);
        let (disc, left) = (&self.disc, &self.left);
        let left = |edge| left.binary_search_by_key(&edge, |&(edge, ..)| edge).ok().map(|at| left[at].2);
        let allowed = |vertex| disc.contains(scene.mesh, vertex);
        let region = divide(&mut self.flood, scene, points, &allowed, &left, false, regions);
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

/// Fills both sides of the path that `flood` was told, and notes the inside; with `turned` the other side.
fn divide(
    flood: &mut Flood,
    scene: &Scene<'_>,
    points: &[PathPoint],
    allowed: &dyn Fn(VertexId) -> bool,
    left: &dyn Fn(EdgeId) -> Option<VertexId>,
    turned: bool,
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
        let mut inside = choose_side(flood, scene, points, &terms);
        if turned {
            inside = 1 - inside;
            flood.complete(scene.mesh, &terms);
        }
        regions.vertices.extend_from_slice(flood.side(inside));
    }
    InsideRegion { partitioning, vertices: first..regions.vertices.len(), ..InsideRegion::default() }
}

/// A third of the area of the faces round a vertex, in square metres.
///
/// Each face counts half from either of its edges at the vertex. Edges are numbered by their vertices, and two numbers have one sum: so the
/// order of the faces changes no digit, and exact ties stay ties.
pub(crate) fn vertex_area(scene: &Scene<'_>, vertex: VertexId) -> f64 {
    let area = |face: &FaceId| {
        let mut corners = scene.mesh.face(*face);
        corners.sort_unstable();
        let [a, b, c] = corners.map(|corner| scene.frame.position(corner));
        (b - a).cross(&(c - a)).norm() / 12.0
    };
    let beside = |&edge: &EdgeId| scene.mesh.edge_faces(edge).iter().map(area).sum::<f64>();
    scene.mesh.vertex_edges(vertex).iter().map(beside).sum()
}
