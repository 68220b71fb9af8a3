//! From paths to their inside regions.

use super::{
    InsideRegion, InsideRegions,
    disc::Disc,
    flood::{Flood, Separation},
};
use crate::{
    frame::Frame,
    mesh::{Mesh, VertexId},
    paths::{IntersectionPaths, PathCopy, PathType, SurfacePoint},
    settings::{InsideChoice, Settings},
};

/// Finds inside regions, reusing its memory from frame to frame.
#[derive(Debug, Default)]
pub struct RegionFinder {
    flood: Flood,
    disc: Disc,
}

impl RegionFinder {
    /// Finds the inside regions of all paths of a frame.
    ///
    /// Cost: for each path linear in its segments and in the size of its smaller side.
    pub fn find(
        &mut self,
        mesh: &Mesh,
        frame: &Frame,
        paths: &IntersectionPaths,
        settings: &Settings,
        regions: &mut InsideRegions,
    ) {
        regions.by_copy.clear();
        regions.vertices.clear();
        for (index, copy) in paths.copies.iter().enumerate() {
            let region = match copy.path_type {
                PathType::Closed | PathType::LoopLoop | PathType::BoundaryBoundary => {
                    Some(self.partition(mesh, frame, paths, &[index], settings, regions))
                }
                PathType::BoundaryLoopInside | PathType::BoundaryLoopBoundary => {
                    Some(self.cut_disc(mesh, frame, paths, copy, settings, regions))
                }
                PathType::BoundaryInside | PathType::InsideInside => None,
            };
            regions.by_copy.push(region);
            self.join_copies(mesh, frame, paths, index, settings, regions);
        }
    }

    /// Where neither of two corresponding paths separates, both together may: two hem-to-hem paths on a tube.
    fn join_copies(
        &mut self,
        mesh: &Mesh,
        frame: &Frame,
        paths: &IntersectionPaths,
        second: usize,
        settings: &Settings,
        regions: &mut InsideRegions,
    ) {
        let first = paths.copies[second].partner;
        let fails = |copy: usize| regions.by_copy[copy].as_ref().is_some_and(|region| !region.partitioning);
        if first < second && fails(first) && fails(second) {
            let region = self.partition(mesh, frame, paths, &[first, second], settings, regions);
            if region.partitioning {
                let empty = InsideRegion { partitioning: true, ..InsideRegion::default() };
                regions.by_copy[second] = Some(empty);
            }
            regions.by_copy[first] = Some(region);
        }
    }

    /// The smaller side of one path, or of several together.
    fn partition(
        &mut self,
        mesh: &Mesh,
        frame: &Frame,
        paths: &IntersectionPaths,
        copies: &[usize],
        settings: &Settings,
        regions: &mut InsideRegions,
    ) -> InsideRegion {
        self.flood.begin(mesh);
        for &copy in copies {
            self.cross_edges(paths, &paths.copies[copy]);
        }
        let separation = fill(&mut self.flood, mesh, frame, settings, |_| true);
        self.region(separation, None, regions)
    }

    /// The smaller side of the disc round the loop vertex of a BLI path.
    fn cut_disc(
        &mut self,
        mesh: &Mesh,
        frame: &Frame,
        paths: &IntersectionPaths,
        copy: &PathCopy,
        settings: &Settings,
        regions: &mut InsideRegions,
    ) -> InsideRegion {
        let points = &paths.points[copy.points.clone()];
        let centre = points.iter().find_map(|point| match point.own {
            SurfacePoint::Vertex(vertex) => Some(vertex),
            _ => None,
        });
        let (Some(centre), Some(first), Some(last)) = (centre, points.first(), points.last()) else {
            return InsideRegion::default();
        };
        let Some(radius) = self.disc.unfold(mesh, frame, centre, [first.own, last.own]) else {
            return InsideRegion::default();
        };
        self.flood.begin(mesh);
        self.cross_edges(paths, copy);
        let disc = &self.disc;
        let separation = fill(&mut self.flood, mesh, frame, settings, |vertex| disc.contains(vertex));
        self.region(separation, Some(radius), regions)
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

    fn region(&self, separation: Separation, disc_radius: Option<f64>, regions: &mut InsideRegions) -> InsideRegion {
        let first = regions.vertices.len();
        if separation == Separation::Two {
            regions.vertices.extend_from_slice(self.flood.smaller());
        }
        InsideRegion {
            partitioning: separation == Separation::Two,
            vertices: first..regions.vertices.len(),
            disc_radius,
        }
    }
}

fn fill(
    flood: &mut Flood,
    mesh: &Mesh,
    frame: &Frame,
    settings: &Settings,
    allowed: impl Fn(VertexId) -> bool,
) -> Separation {
    let area = |vertex| vertex_area(mesh, frame, vertex);
    match settings.inside {
        InsideChoice::Count => flood.fill(mesh, allowed, |_| 1.0, area),
        InsideChoice::Area => flood.fill(mesh, allowed, area, |_| 1.0),
    }
}

/// A third of the area of the faces round a vertex, in square metres.
fn vertex_area(mesh: &Mesh, frame: &Frame, vertex: VertexId) -> f64 {
    let area = |face: &crate::mesh::FaceId| {
        let [a, b, c] = mesh.face(*face).map(|corner| frame.position(corner));
        (b - a).cross(&(c - a)).norm() / 6.0
    };
    mesh.vertex_faces(vertex).iter().map(area).sum()
}
