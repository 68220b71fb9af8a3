//! One segment against one triangle, closed sets, exact.

use robust::{Coord, Coord3D};

/// A position in metres.
pub type Point = [f64; 3];

pub(crate) type Point2 = [f64; 2];

/// Whether a segment and a triangle have a point in common. Either may be degenerate: a segment of no length, a
/// triangle of no area.
pub(super) fn segment_meets_triangle([p, q]: [Point; 2], [a, b, c]: [Point; 3]) -> bool {
    let Some(dropped) =
        (0..3).find(|&axis| orient2d(project(a, axis), project(b, axis), project(c, axis)) != Sign::Zero)
    else {
        // No projection has an area, so the triangle is a segment or a point: the union of its sides.
        return [[a, b], [b, c], [c, a]].into_iter().any(|side| segments_meet([p, q], side));
    };
    match (orient3d(a, b, c, p), orient3d(a, b, c, q)) {
        (Sign::Zero, Sign::Zero) => {
            let [p, q, a, b, c] = [p, q, a, b, c].map(|point| project(point, dropped));
            segment_meets_triangle_in_plane([p, q], [a, b, c])
        }
        (at_p, at_q) if at_p == at_q => false,
        // The line meets the plane in one point, and that lies in the segment. It lies in the triangle unless the line
        // passes on different sides of two of the triangle's sides.
        _ => {
            let turns = [orient3d(p, q, a, b), orient3d(p, q, b, c), orient3d(p, q, c, a)];
            !(turns.contains(&Sign::Positive) && turns.contains(&Sign::Negative))
        }
    }
}

fn segment_meets_triangle_in_plane([p, q]: [Point2; 2], [a, b, c]: [Point2; 3]) -> bool {
    let contains = |point| {
        let turns = [orient2d(a, b, point), orient2d(b, c, point), orient2d(c, a, point)];
        !(turns.contains(&Sign::Positive) && turns.contains(&Sign::Negative))
    };
    contains(p) || [[a, b], [b, c], [c, a]].into_iter().any(|side| segments_meet_in_plane([p, q], side))
}

/// Whether two segments in space have a point in common.
///
/// Points in one plane keep their incidences in at least one of the three projections (the one in which the plane has
/// an area; any, for points on one line that is not seen end on), and a common point is common in every projection.
fn segments_meet([p, q]: [Point; 2], [a, b]: [Point; 2]) -> bool {
    orient3d(p, q, a, b) == Sign::Zero
        && (0..3).all(|axis| {
            segments_meet_in_plane([project(p, axis), project(q, axis)], [project(a, axis), project(b, axis)])
        })
}

fn segments_meet_in_plane([p, q]: [Point2; 2], [a, b]: [Point2; 2]) -> bool {
    let boxes_overlap =
        (0..2).all(|axis| p[axis].min(q[axis]) <= a[axis].max(b[axis]) && a[axis].min(b[axis]) <= p[axis].max(q[axis]));
    // Neither segment lies strictly on one side of the other's line. With overlapping boxes this suffices, on one line
    // too.
    let straddles = |one: Sign, other: Sign| one != other || one == Sign::Zero;
    boxes_overlap && straddles(orient2d(p, q, a), orient2d(p, q, b)) && straddles(orient2d(a, b, p), orient2d(a, b, q))
}

/// The sign of a determinant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sign {
    Negative,
    Zero,
    Positive,
}

fn sign(value: f64) -> Sign {
    if value > 0.0 {
        Sign::Positive
    } else if value < 0.0 {
        Sign::Negative
    } else {
        Sign::Zero
    }
}

pub(crate) fn orient2d(a: Point2, b: Point2, c: Point2) -> Sign {
    let coord = |[x, y]: Point2| Coord { x, y };
    sign(robust::orient2d(coord(a), coord(b), coord(c)))
}

pub(crate) fn orient3d(a: Point, b: Point, c: Point, d: Point) -> Sign {
    let coord = |[x, y, z]: Point| Coord3D { x, y, z };
    sign(robust::orient3d(coord(a), coord(b), coord(c), coord(d)))
}

/// The point seen along an axis.
pub(crate) fn project(point: Point, axis: usize) -> Point2 {
    [point[(axis + 1) % 3], point[(axis + 2) % 3]]
}
