//! Intersection paths (contours) as lines, for Blender, MeshLab and Houdini.

use std::io::{self, Write};

use untangle::paths::{IntersectionPaths, PairType, PathPoint};

use crate::formats::text::write_number;

/// One polyline.
struct Line<'a> {
    pair: usize,
    pair_type: PairType,
    points: &'a [PathPoint],
    closed: bool,
}

impl Line<'_> {
    fn num_edges(&self) -> usize {
        if self.closed { self.points.len() } else { self.points.len().saturating_sub(1) }
    }
}

/// The polylines, pair by pair. Two corresponding paths run through the same points, so only the first is drawn. A path
/// that is its own partner runs to a loop vertex and back, so only its first half is drawn.
fn lines(paths: &IntersectionPaths) -> impl Iterator<Item = Line<'_>> {
    paths.pairs.iter().enumerate().flat_map(move |(number, pair)| {
        pair.copies.clone().filter(move |&at| paths.copies[at].partner >= at).map(move |at| {
            let copy = &paths.copies[at];
            let points = &paths.points[copy.points.clone()];
            let is_own_partner = copy.partner == at;
            let closed = copy.closed && !is_own_partner;
            let count = match (is_own_partner, closed) {
                (true, _) => points.len().min(copy.segments.len() / 2 + 1),
                (false, true) => points.len().saturating_sub(1),
                (false, false) => points.len(),
            };
            Line { pair: number, pair_type: pair.pair_type, points: &points[..count], closed }
        })
    })
}

/// Writes the paths as an OBJ of one `l` element each, in groups named by the type and the number of the pair: `g
/// CLOSED_0`.
///
/// # Errors
/// What writing to `out` gives.
pub fn write_contours_obj(paths: &IntersectionPaths, out: &mut dyn Write) -> io::Result<()> {
    let mut next_vertex = 1;
    for line in lines(paths) {
        writeln!(out, "g {}_{}", style(line.pair_type).0, line.pair)?;
        for point in line.points {
            write!(out, "v")?;
            for &coordinate in &point.position.coords {
                write!(out, " ")?;
                write_number(coordinate, out)?;
            }
            writeln!(out)?;
        }
        write!(out, "l")?;
        for vertex in next_vertex..next_vertex + line.points.len() {
            write!(out, " {vertex}")?;
        }
        if line.closed {
            write!(out, " {next_vertex}")?;
        }
        writeln!(out)?;
        next_vertex += line.points.len();
    }
    Ok(())
}

/// Writes the paths as an ascii PLY of vertices, coloured by type, and edges.
///
/// # Errors
/// What writing to `out` gives.
pub fn write_contours_ply(paths: &IntersectionPaths, out: &mut dyn Write) -> io::Result<()> {
    let num_vertices: usize = lines(paths).map(|line| line.points.len()).sum();
    let num_edges: usize = lines(paths).map(|line| line.num_edges()).sum();
    writeln!(out, "ply\nformat ascii 1.0\ncomment intersection paths, coloured by type")?;
    writeln!(out, "element vertex {num_vertices}\nproperty double x\nproperty double y\nproperty double z")?;
    writeln!(out, "property uchar red\nproperty uchar green\nproperty uchar blue")?;
    writeln!(out, "element edge {num_edges}\nproperty int vertex1\nproperty int vertex2\nend_header")?;
    for line in lines(paths) {
        let [red, green, blue] = style(line.pair_type).1;
        for point in line.points {
            for &coordinate in &point.position.coords {
                write_number(coordinate, out)?;
                write!(out, " ")?;
            }
            writeln!(out, "{red} {green} {blue}")?;
        }
    }
    let mut first = 0;
    for line in lines(paths) {
        for edge in 0..line.num_edges() {
            writeln!(out, "{} {}", first + edge, first + (edge + 1) % line.points.len())?;
        }
        first += line.points.len();
    }
    Ok(())
}

/// Name of the group, without a slash, and colour of a type. The palette follows Okabe and Ito (2008), which the
/// colour-blind can tell apart.
fn style(pair_type: PairType) -> (&'static str, [u8; 3]) {
    match pair_type {
        PairType::Closed => ("CLOSED", [0, 114, 178]),
        PairType::Eight => ("EIGHT", [86, 180, 233]),
        PairType::LoopLoop => ("LL", [204, 121, 167]),
        PairType::BoundaryLoopInside => ("BLI", [213, 94, 0]),
        PairType::BoundaryLoopBoundary => ("BLB", [230, 159, 0]),
        PairType::BoundaryLoopLoopBoundary => ("BLLB", [240, 228, 66]),
        PairType::Cross => ("CROSS", [170, 60, 60]),
        PairType::BoundaryBoundaryInsideInside => ("BB_II", [0, 158, 115]),
        PairType::BoundaryBoundaryBoundaryInside => ("BB_BI", [120, 200, 140]),
        PairType::BoundaryBoundaryBoundaryBoundary => ("BB_BB", [60, 120, 60]),
        PairType::BoundaryInside => ("BI_BI", [0, 0, 0]),
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Point3;

    use super::*;
    use untangle::{
        mesh::{FaceId, VertexId},
        paths::{PathCopy, PathPair, PathSegment, PathType, SurfacePoint},
    };

    fn point(x: f64) -> PathPoint {
        let place = SurfacePoint::Vertex(VertexId(0));
        PathPoint { position: Point3::new(x, 0.5, -0.25), own: place, partner: place }
    }

    fn pair(pair_type: PairType, closed: bool, copies: std::ops::Range<usize>) -> PathPair {
        let (loop_vertices, ends) = Default::default();
        PathPair { pair_type, closed, num_segments: 2, length_m: 1.0, loop_vertices, ends, copies }
    }

    /// A pair of closed paths of three segments, and a path of two segments to a loop vertex and back.
    fn paths() -> IntersectionPaths {
        let copy = |path_type, closed, points, segments, partner, pair| PathCopy {
            path_type,
            closed,
            points,
            segments,
            partner,
            pair,
        };
        IntersectionPaths {
            pairs: vec![pair(PairType::Closed, true, 0..2), pair(PairType::BoundaryLoopInside, false, 2..3)],
            copies: vec![
                copy(PathType::Closed, true, 0..4, 0..3, 1, 0),
                copy(PathType::Closed, true, 4..8, 3..6, 0, 0),
                copy(PathType::BoundaryLoopInside, false, 8..13, 6..10, 2, 1),
            ],
            points: [0., 1., 2., 0., 0., 1., 2., 0., 5., 6., 7., 6., 5.].map(point).to_vec(),
            segments: vec![PathSegment { own: FaceId(0), partner: FaceId(1) }; 10],
        }
    }

    #[test]
    fn write_contours_obj_writes_a_group_and_a_line_for_each_pair() {
        let mut out = Vec::new();
        write_contours_obj(&paths(), &mut out).unwrap();
        let text = String::from_utf8(out).unwrap();
        let lines: Vec<&str> = text.lines().filter(|line| !line.starts_with('v')).collect();
        assert_eq!(lines, ["g CLOSED_0", "l 1 2 3 1", "g BLI_1", "l 4 5 6"]);
        assert_eq!(text.lines().filter(|line| line.starts_with("v ")).count(), 6);
        assert!(text.contains("v 7 0.5 -0.25\n"));
    }

    #[test]
    fn write_contours_ply_writes_coloured_vertices_and_edges() {
        let mut out = Vec::new();
        write_contours_ply(&paths(), &mut out).unwrap();
        let text = String::from_utf8(out).unwrap();
        assert!(text.contains("element vertex 6\n") && text.contains("element edge 5\n"));
        assert!(text.contains("7 0.5 -0.25 213 94 0\n"));
        assert!(text.ends_with("0 1\n1 2\n2 0\n3 4\n4 5\n"));
    }
}
