//! The rules that every analysis obeys, checked from the outside.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Point3;
use untangle::{
    analysis::Analysis,
    frame::Frame,
    intersect::SegmentEnd,
    mesh::{EdgeId, Mesh, VertexId},
    paths::{PathCopy, PathType, SurfacePoint},
};

/// Checks all rules for the analysis of a sheet without holes; `size` is the extent of the cloth in metres.
pub fn check(mesh: &Mesh, frame: &Frame, analysis: &Analysis, size: f64) {
    check_paths(mesh, frame, analysis, size);
    regions_are_bounded_by_their_paths(mesh, analysis);
}

/// Checks the rules that hold for any mesh.
pub fn check_paths(mesh: &Mesh, frame: &Frame, analysis: &Analysis, size: f64) {
    segments(mesh, analysis);
    every_segment_lies_on_one_path(analysis);
    points_touch_both_sheets(mesh, frame, analysis, 1e-9 * size);
    copies_correspond(analysis);
    copies_correspond_point_by_point(analysis);
    regions_hold_no_loop_vertex(analysis);
}

/// Faces without a common vertex meet in 0 or 2 edge-face intersections, with one in 0 or 1 (and the segment ends in
/// that vertex), with two never.
fn segments(mesh: &Mesh, analysis: &Analysis) {
    let found = &analysis.intersections;
    for segment in &found.segments {
        let [first, second] = segment.faces.map(|face| mesh.face(face));
        assert!(segment.faces[0] < segment.faces[1]);
        let common: Vec<VertexId> = first.into_iter().filter(|vertex| second.contains(vertex)).collect();
        let joins = |end: u32| {
            let hit = &found.edge_face[end as usize];
            let owner = if segment.faces[0] == hit.face { segment.faces[1] } else { segment.faces[0] };
            segment.faces.contains(&hit.face) && mesh.edge_faces(hit.edge).contains(&owner)
        };
        match (common.as_slice(), segment.ends) {
            ([], [SegmentEnd::EdgeFace(a), SegmentEnd::EdgeFace(b)]) => assert!(a != b && joins(a) && joins(b)),
            ([shared], [SegmentEnd::EdgeFace(a), SegmentEnd::LoopVertex(vertex)]) => {
                assert!(joins(a) && vertex == *shared);
            }
            _ => panic!("{segment:?} between faces with common vertices {common:?}"),
        }
    }
    for hit in &found.edge_face {
        let sum: f64 = hit.barycentric.iter().sum();
        assert!((sum - 1.0).abs() < 1e-9 && (0.0..=1.0).contains(&hit.edge_parameter), "{hit:?}");
        assert!(hit.barycentric.iter().all(|weight| (-1e-9..=1.0 + 1e-9).contains(weight)), "{hit:?}");
    }
}

fn every_segment_lies_on_one_path(analysis: &Analysis) {
    let Analysis { intersections, paths, .. } = analysis;
    let along_pairs: usize = paths.pairs.iter().map(|pair| pair.num_segments).sum();
    assert_eq!(along_pairs, intersections.segments.len());
    // Each segment is run through twice: once on each sheet.
    let mut runs: BTreeMap<[u32; 2], Vec<bool>> = BTreeMap::new();
    for segment in &paths.segments {
        let [own, partner] = [segment.own.0, segment.partner.0];
        runs.entry([own.min(partner), own.max(partner)]).or_default().push(own < partner);
    }
    assert_eq!(runs.len(), intersections.segments.len());
    for segment in &intersections.segments {
        let mut run = runs[&segment.faces.map(|face| face.0)].clone();
        run.sort_unstable();
        assert_eq!(run, [false, true], "{segment:?}");
    }
}

fn place(mesh: &Mesh, frame: &Frame, point: SurfacePoint) -> Point3<f64> {
    let weighted = |terms: &[(VertexId, f64)]| -> Point3<f64> {
        terms
            .iter()
            .map(|&(vertex, weight)| frame.position(vertex).coords * weight)
            .sum::<nalgebra::Vector3<f64>>()
            .into()
    };
    match point {
        SurfacePoint::Vertex(vertex) => frame.position(vertex),
        SurfacePoint::Edge { edge, parameter } => {
            let [a, b] = mesh.edge(edge);
            weighted(&[(a, 1.0 - parameter), (b, parameter)])
        }
        SurfacePoint::Face { face, barycentric } => {
            let [a, b, c] = mesh.face(face);
            weighted(&[(a, barycentric[0]), (b, barycentric[1]), (c, barycentric[2])])
        }
    }
}

fn points_touch_both_sheets(mesh: &Mesh, frame: &Frame, analysis: &Analysis, tolerance: f64) {
    for point in &analysis.paths.points {
        for on_sheet in [point.own, point.partner] {
            let distance = (place(mesh, frame, on_sheet) - point.position).norm();
            assert!(distance <= tolerance, "{point:?} is {distance} m off its sheet");
        }
    }
}

fn copies_correspond(analysis: &Analysis) {
    let paths = &analysis.paths;
    for (at, copy) in paths.copies.iter().enumerate() {
        assert_eq!(copy.points.len(), copy.segments.len() + 1);
        assert_eq!(paths.copies[copy.partner].partner, at);
        assert!(paths.pairs[copy.pair].copies.contains(&at));
        let partner = &paths.copies[copy.partner];
        let swapped: BTreeSet<_> =
            paths.segments[partner.segments.clone()].iter().map(|s| (s.partner, s.own)).collect();
        let own: BTreeSet<_> = paths.segments[copy.segments.clone()].iter().map(|s| (s.own, s.partner)).collect();
        assert_eq!(own, swapped, "copy {at} and its partner run through the same pairs of faces");
        let points = &paths.points[copy.points.clone()];
        let returns = points[0].own == points[points.len() - 1].own;
        assert_eq!(copy.closed, matches!(copy.path_type, PathType::Closed | PathType::LoopLoop));
        assert!(!copy.closed || returns, "copy {at} is closed but ends elsewhere");
        let is_own = matches!(
            copy.path_type,
            PathType::LoopLoop | PathType::BoundaryLoopInside | PathType::BoundaryLoopBoundary
        );
        // A closed path on cloth with one side only may come back on the other sheet.
        let may_be_own = copy.path_type == PathType::Closed;
        assert!(copy.partner == at || !is_own, "copy {at} ({:?}) has another partner", copy.path_type);
        assert!(copy.partner != at || is_own || may_be_own, "copy {at} is its own partner");
    }
}

/// A path and its corresponding path run through the same places of the world at the same arclengths, each where the
/// other says.
fn copies_correspond_point_by_point(analysis: &Analysis) {
    let paths = &analysis.paths;
    for (at, copy) in paths.copies.iter().enumerate() {
        let (points, lengths) = (&paths.points[copy.points.clone()], paths.arclengths_m(copy).collect::<Vec<_>>());
        assert_eq!(lengths.len(), points.len());
        assert!(lengths.is_sorted() && lengths[0].abs() <= 0.0);
        let other = &paths.copies[copy.partner];
        let other_points = &paths.points[other.points.clone()];
        if copy.partner != at {
            let there = points.iter().map(|point| (point.position, point.own, point.partner));
            let here = other_points.iter().map(|point| (point.position, point.partner, point.own));
            assert!(there.eq(here), "copies {at} and {} differ", copy.partner);
            assert_eq!(lengths, paths.arclengths_m(other).collect::<Vec<_>>());
        } else if copy.path_type != PathType::Closed {
            // Folded: the path returns through the same points in reverse order, its sheets exchanged.
            let there = points.iter().map(|point| (point.position, point.own, point.partner));
            let back = points.iter().rev().map(|point| (point.position, point.partner, point.own));
            assert!(there.eq(back), "copy {at} does not fold back onto itself");
        }
    }
}

fn regions_hold_no_loop_vertex(analysis: &Analysis) {
    let Analysis { paths, regions, .. } = analysis;
    assert_eq!(regions.by_copy.len(), paths.copies.len());
    for (at, copy) in paths.copies.iter().enumerate() {
        let inside = regions.vertices_of(at);
        assert!(inside.windows(2).all(|pair| pair[0] < pair[1]), "sorted, each once");
        for point in &paths.points[copy.points.clone()] {
            if let SurfacePoint::Vertex(vertex) = point.own {
                assert!(inside.binary_search(&vertex).is_err(), "copy {at} has {vertex:?} inside");
            }
        }
        let has_region = !matches!(copy.path_type, PathType::BoundaryInside | PathType::InsideInside);
        let is_joint = regions.by_copy[at].as_ref().is_some_and(|region| region.joint);
        assert_eq!(regions.by_copy[at].is_some(), has_region || is_joint);
        assert!(inside.is_empty() || regions.by_copy[at].as_ref().is_some_and(|region| region.partitioning));
    }
}

/// How often a path crosses each edge.
fn crossings(paths: &untangle::paths::IntersectionPaths, copy: &PathCopy) -> BTreeMap<EdgeId, usize> {
    let points = &paths.points[copy.points.clone()];
    // A closed path repeats its first point.
    let count = points.len() - usize::from(copy.closed);
    let mut crossings = BTreeMap::new();
    for point in &points[..count] {
        if let SurfacePoint::Edge { edge, .. } = point.own {
            *crossings.entry(edge).or_default() += 1;
        }
    }
    crossings
}

/// On a sheet without holes CLOSED, LL and BB divide the vertices (but for loop vertices) in two, just along the path;
/// every path with a region is partitioning; no region holds a loop vertex of its path.
fn regions_are_bounded_by_their_paths(mesh: &Mesh, analysis: &Analysis) {
    let Analysis { paths, regions, .. } = analysis;
    for (at, copy) in paths.copies.iter().enumerate() {
        let Some(region) = regions.by_copy[at].as_ref() else { continue };
        assert!(region.partitioning, "copy {at} ({:?}) does not separate", copy.path_type);
        let inside: BTreeSet<VertexId> = regions.vertices_of(at).iter().copied().collect();
        let points = &paths.points[copy.points.clone()];
        let at_loop: BTreeSet<VertexId> = points
            .iter()
            .filter_map(|point| if let SurfacePoint::Vertex(vertex) = point.own { Some(vertex) } else { None })
            .collect();
        if matches!(copy.path_type, PathType::BoundaryLoopInside | PathType::BoundaryLoopBoundary) {
            continue;
        }
        let crossings = crossings(paths, copy);
        for edge in mesh.edge_ids() {
            let [a, b] = mesh.edge(edge);
            if at_loop.contains(&a) || at_loop.contains(&b) {
                continue;
            }
            let crossed = crossings.get(&edge).is_some_and(|count| count % 2 == 1);
            assert_eq!(
                inside.contains(&a) != inside.contains(&b),
                crossed,
                "copy {at} ({:?}) at {edge:?}",
                copy.path_type
            );
        }
    }
}
