//! Proper crossings: what no small motion of the vertices undoes, and no choice between touching sheets explains.
//!
//! - The interiors of two triangles that are not in one plane have a common point.
//! - An edge runs through the interior of a triangle, in its plane, and two triangles at the edge lie on different
//!   sides of that plane.
//! - Two edges lie over each other, and the triangles round them alternate.
//!
//! Sheets that touch, in points, along curves or over areas, do not cross.

use crate::primitive::{Point, Point2, Sign, orient2d, orient3d, project};

type Triangle = [Point; 3];

/// The signs of three points to the plane of a triangle.
pub(crate) fn sides(points: Triangle, triangle: Triangle) -> [Sign; 3] {
    let [a, b, c] = triangle;
    // A common corner needs no arithmetic, and neighbours have one.
    points.map(|point| if triangle.contains(&point) { Sign::Zero } else { orient3d(a, b, c, point) })
}

/// Whether two triangles, seen along an axis, are parted by a side of one of them, but for a common corner.
///
/// This decides most pairs of long triangles in nearly one plane, for which the signs in space cost far more: they are
/// next to zero.
pub(crate) fn are_apart(first: Triangle, second: Triangle) -> bool {
    let axis = axis_of_most_area(first);
    let [first, second] = [first, second].map(|triangle| triangle.map(|point| project(point, axis)));
    let parts = |[a, b, c]: [Point2; 3], others: [Point2; 3]| {
        let inner = orient2d(a, b, c);
        let is_beyond = |p: Point2, q: Point2| {
            let is_end = |point: Point2| [p, q].contains(&point);
            let is_outside = |point: Point2| {
                let side = orient2d(p, q, point);
                side != Sign::Zero && side != inner
            };
            // One common corner is no edge over another.
            others.into_iter().filter(|&point| is_end(point)).count() <= 1
                && others.into_iter().all(|point| is_outside(point) || is_end(point))
        };
        inner != Sign::Zero && (is_beyond(a, b) || is_beyond(b, c) || is_beyond(c, a))
    };
    parts(first, second) || parts(second, first)
}

/// The axis along which a triangle shows about its largest area; any one is right.
fn axis_of_most_area([a, b, c]: Triangle) -> usize {
    let area = |axis: usize| {
        let [a, b, c] = [a, b, c].map(|point| project(point, axis));
        ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).abs()
    };
    let areas = [area(0), area(1), area(2)];
    (1..3).fold(0, |best, axis| if areas[axis] > areas[best] { axis } else { best })
}

/// The corner that is alone strictly on its side of a plane with corners strictly on both sides.
fn lone_corner(sides: [Sign; 3]) -> Option<usize> {
    let only = |wanted: Sign| {
        let mut corners = (0..3).filter(|&corner| sides[corner] == wanted);
        (corners.next(), corners.next())
    };
    match (only(Sign::Positive), only(Sign::Negative)) {
        ((None, _), _) | (_, (None, _)) => None,
        ((Some(corner), None), _) | (_, (Some(corner), _)) => Some(corner),
    }
}

/// Whether the interiors of two triangles that are not in one plane have a common point.
///
/// The sides are the signs of the corners of each to the plane of the other. Each triangle cuts that plane in an open
/// interval of the line that both planes share; two more signs say whether the intervals overlap (Guigue and Devillers
/// 2003, with strict signs).
pub(crate) fn interiors_cross(first: Triangle, second: Triangle, [first_sides, second_sides]: [[Sign; 3]; 2]) -> bool {
    let (Some(i), Some(j)) = (lone_corner(first_sides), lone_corner(second_sides)) else { return false };
    let turned = |triangle: Triangle, start: usize| [0, 1, 2].map(|k| triangle[(start + k) % 3]);
    let [p, mut p1, mut p2] = turned(first, i);
    let [q, mut q1, mut q2] = turned(second, j);
    // Turning the other triangle over brings each lone corner to the positive side of its plane.
    if first_sides[i] == Sign::Negative {
        (q1, q2) = (q2, q1);
    }
    if second_sides[j] == Sign::Negative {
        (p1, p2) = (p2, p1);
    }
    orient3d(p, p1, q, q1) == Sign::Negative && orient3d(p, p2, q2, q) == Sign::Negative
}

/// [`interiors_cross`] with nothing known.
pub(crate) fn triangles_cross(first: Triangle, second: Triangle) -> bool {
    let first_sides = sides(first, second);
    lone_corner(first_sides).is_some() && interiors_cross(first, second, [first_sides, sides(second, first)])
}

/// The corner opposite to the edge that lies in a plane, if one does, from the signs of the corners.
pub(crate) fn tip_of_edge_in_plane(sides: [Sign; 3]) -> Option<usize> {
    let mut off = (0..3).filter(|&corner| sides[corner] != Sign::Zero);
    let tip = off.next()?;
    off.next().is_none().then_some(tip)
}

/// Whether an edge in the plane of a triangle has a point in common with its interior, ends of the edge left out.
pub(crate) fn runs_through([s, t]: [Point; 2], triangle: Triangle) -> bool {
    let [a, b, c] = triangle;
    let area = |axis: usize| orient2d(project(a, axis), project(b, axis), project(c, axis));
    let Some(axis) = (0..3).find(|&axis| area(axis) != Sign::Zero) else { return false };
    let inner = area(axis);
    let [s, t, a, b, c] = [s, t, a, b, c].map(|point| project(point, axis));
    // Two convex sets in a plane are apart if a side of one of them separates them.
    let is_beyond = |p, q| [s, t].into_iter().all(|end| orient2d(p, q, end) != inner);
    let turns = [a, b, c].map(|corner| orient2d(s, t, corner));
    !(is_beyond(a, b) || is_beyond(b, c) || is_beyond(c, a))
        && turns.contains(&Sign::Positive)
        && turns.contains(&Sign::Negative)
}

/// Whether two edges lie on one line and have more than a point in common.
pub(crate) fn overlap([s, t]: [Point; 2], [u, v]: [Point; 2]) -> bool {
    let on_line =
        |point| (0..3).all(|axis| orient2d(project(s, axis), project(t, axis), project(point, axis)) == Sign::Zero);
    let on_axis = |axis: usize| {
        let low = s[axis].min(t[axis]).max(u[axis].min(v[axis]));
        let high = s[axis].max(t[axis]).min(u[axis].max(v[axis]));
        low < high
    };
    on_line(u) && on_line(v) && (0..3).any(on_axis)
}

/// Whether of four wings round a line `s t` those of `first` and those of `second` alternate.
pub(crate) fn alternate([s, t]: [Point; 2], first: [Point; 2], second: [Point; 2]) -> bool {
    let [b1, b2] = second;
    let [from, to] = first;
    (is_between(s, t, [from, to], b1) && is_between(s, t, [to, from], b2))
        || (is_between(s, t, [from, to], b2) && is_between(s, t, [to, from], b1))
}

/// Whether a wing lies strictly within the turn round `s t` from one wing to another, in the sense of positive signs.
fn is_between(s: Point, t: Point, [from, to]: [Point; 2], wing: Point) -> bool {
    let turn = |a, b| orient3d(s, t, a, b);
    match turn(from, to) {
        // Less than half a turn.
        Sign::Positive => turn(from, wing) == Sign::Positive && turn(wing, to) == Sign::Positive,
        // More than half a turn: all but the rest of it.
        Sign::Negative => !(turn(to, wing) != Sign::Negative && turn(wing, from) != Sign::Negative),
        // Half a turn, or none or a whole one, in which nothing can be told.
        Sign::Zero => turn(from, wing) == Sign::Positive && !is_same_half(s, t, from, to),
    }
}

/// Whether two points in one plane with a line lie on the same side of it.
fn is_same_half(s: Point, t: Point, a: Point, b: Point) -> bool {
    (0..3).any(|axis| {
        let [s, t, a, b] = [s, t, a, b].map(|point| project(point, axis));
        let turns = [orient2d(s, t, a), orient2d(s, t, b)];
        turns[0] != Sign::Zero && turns[0] == turns[1]
    })
}
