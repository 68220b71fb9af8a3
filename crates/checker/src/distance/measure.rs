//! Whether two primitives are nearer than a distance, as comparisons of polynomials.
//!
//! The least distance is taken between a corner and a corner, a corner and the inside of an edge, a corner and the
//! inside of a triangle, or the insides of two edges. Two primitives are nearer than a distance if one of these is.

use std::cmp::Ordering;

use crate::primitive::Point;

use super::number::{Interval, Number, whole};

type Vector<N> = [N; 3];

/// Whether a point is nearer to a triangle than a distance.
pub(super) fn vertex_near(vertex: Point, [a, b, c]: [Point; 3], distance: f64) -> bool {
    let points = [vertex, a, b, c];
    if are_parted([&points[..1], &points[1..]], distance) {
        return false;
    }
    let quick = of_vertex(&points.map(|point| point.map(Interval::exactly)), &Interval::exactly(distance));
    quick.unwrap_or_else(|| {
        let (points, distance) = whole(points, distance);
        known(of_vertex(&points, &distance))
    })
}

/// Whether two segments are nearer than a distance.
pub(super) fn edges_near([a, b]: [Point; 2], [c, d]: [Point; 2], distance: f64) -> bool {
    let points = [a, b, c, d];
    if are_parted([&points[..2], &points[2..]], distance) {
        return false;
    }
    let quick = of_edges(&points.map(|point| point.map(Interval::exactly)), &Interval::exactly(distance));
    quick.unwrap_or_else(|| {
        let (points, distance) = whole(points, distance);
        known(of_edges(&points, &distance))
    })
}

fn known(answer: Option<bool>) -> bool {
    answer.unwrap_or_else(|| unreachable!("whole numbers have an order"))
}

/// Whether the direction between the middles of two primitives shows that they are no nearer than a distance.
fn are_parted([first, second]: [&[Point]; 2], distance: f64) -> bool {
    let middle = |points: &[Point], axis: usize| {
        let sum: f64 = points.iter().map(|point| point[axis]).sum();
        if points.len() == 3 {
            sum / 3.0
        } else if points.len() == 2 {
            sum / 2.0
        } else {
            sum
        }
    };
    // Any direction is as right as another: it is taken as exact.
    let direction = [0, 1, 2].map(|axis| Interval::exactly(middle(first, axis) - middle(second, axis)));
    let needed = squared(&Interval::exactly(distance)).times(&dot(&direction, &direction));
    first.iter().all(|p| {
        second.iter().all(|q| {
            let along = dot(&sub(&p.map(Interval::exactly), &q.map(Interval::exactly)), &direction);
            along.order() == Some(Ordering::Greater) && needed.is_less(&squared(&along)) == Some(true)
        })
    })
}

fn of_vertex<N: Number>([p, a, b, c]: &[Vector<N>; 4], distance: &N) -> Option<bool> {
    let limit = squared(distance);
    any([
        point_and_edge(p, [a, b], &limit),
        point_and_edge(p, [b, c], &limit),
        point_and_edge(p, [c, a], &limit),
        point_and_inside(p, [a, b, c], &limit),
    ])
}

fn of_edges<N: Number>([a, b, c, d]: &[Vector<N>; 4], distance: &N) -> Option<bool> {
    let limit = squared(distance);
    any([
        point_and_edge(a, [c, d], &limit),
        point_and_edge(b, [c, d], &limit),
        point_and_edge(c, [a, b], &limit),
        point_and_edge(d, [a, b], &limit),
        insides([a, b], [c, d], &limit),
    ])
}

/// A point and an edge with both its ends.
fn point_and_edge<N: Number>(p: &Vector<N>, [a, b]: [&Vector<N>; 2], limit: &N) -> Option<bool> {
    let (from_a, from_b, edge) = (sub(p, a), sub(p, b), sub(b, a));
    let past_a = is_positive(&dot(&from_a, &edge));
    let before_b = dot(&from_b, &edge).order().map(|order| order == Ordering::Less);
    // The square of the distance to the line, times that of the edge.
    let area = cross(&from_a, &edge);
    let is_beside = all([past_a, before_b, dot(&area, &area).is_less(&limit.times(&dot(&edge, &edge)))]);
    any([dot(&from_a, &from_a).is_less(limit), dot(&from_b, &from_b).is_less(limit), is_beside])
}

/// A point and the inside of a triangle that has an area.
fn point_and_inside<N: Number>(p: &Vector<N>, [a, b, c]: [&Vector<N>; 3], limit: &N) -> Option<bool> {
    let normal = cross(&sub(b, a), &sub(c, a));
    let size = dot(&normal, &normal);
    let is_within =
        |from: &Vector<N>, to: &Vector<N>| is_positive(&dot(&cross(&normal, &sub(to, from)), &sub(p, from)));
    let height = dot(&sub(p, a), &normal);
    all([is_within(a, b), is_within(b, c), is_within(c, a), squared(&height).is_less(&limit.times(&size))])
}

/// The insides of two edges that are not parallel.
fn insides<N: Number>([a, b]: [&Vector<N>; 2], [c, d]: [&Vector<N>; 2], limit: &N) -> Option<bool> {
    let (u, v) = (sub(b, a), sub(d, c));
    let normal = cross(&u, &v);
    let size = dot(&normal, &normal);
    // Seen along the common normal, the ends of each edge lie on different sides of the other one.
    let parts = |edge: &Vector<N>, from: &Vector<N>, one: &Vector<N>, other: &Vector<N>| {
        let across = cross(&normal, edge);
        let sides = [dot(&across, &sub(one, from)).order(), dot(&across, &sub(other, from)).order()];
        match sides {
            [Some(Ordering::Equal), _] | [_, Some(Ordering::Equal)] => Some(false),
            [Some(one), Some(other)] => Some(one != other),
            _ => None,
        }
    };
    let height = dot(&sub(a, c), &normal);
    all([parts(&u, a, c, d), parts(&v, c, a, b), squared(&height).is_less(&limit.times(&size))])
}

fn any<const N: usize>(answers: [Option<bool>; N]) -> Option<bool> {
    if answers.contains(&Some(true)) { Some(true) } else { (!answers.contains(&None)).then_some(false) }
}

fn all<const N: usize>(answers: [Option<bool>; N]) -> Option<bool> {
    if answers.contains(&Some(false)) { Some(false) } else { (!answers.contains(&None)).then_some(true) }
}

fn is_positive<N: Number>(value: &N) -> Option<bool> {
    value.order().map(|order| order == Ordering::Greater)
}

fn squared<N: Number>(value: &N) -> N {
    value.times(value)
}

fn sub<N: Number>(a: &Vector<N>, b: &Vector<N>) -> Vector<N> {
    [a[0].minus(&b[0]), a[1].minus(&b[1]), a[2].minus(&b[2])]
}

fn dot<N: Number>(a: &Vector<N>, b: &Vector<N>) -> N {
    a[0].times(&b[0]).plus(&a[1].times(&b[1])).plus(&a[2].times(&b[2]))
}

fn cross<N: Number>(a: &Vector<N>, b: &Vector<N>) -> Vector<N> {
    let along = |i: usize, k: usize| a[i].times(&b[k]).minus(&a[k].times(&b[i]));
    [along(1, 2), along(2, 0), along(0, 1)]
}
