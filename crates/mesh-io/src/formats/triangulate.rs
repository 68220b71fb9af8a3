//! Polygons split into triangles.

use robust::{Coord, orient2d};

/// Most orientation signs computed for one polygon, since clipping ears costs O(n^3): a polygon of more than some
/// thousand corners that is far from convex becomes a fan.
const MOST_SIGNS: usize = 20_000_000;

/// Splits one polygon of `n` corners into `n - 2` triangles of its orientation, each emitted as three corner numbers.
///
/// Ears are clipped in the order of the corners, in the coordinate plane in which the polygon's area is largest, and
/// decided by exact signs (Shewchuk 1997). A convex polygon so becomes the fan of its first corner, as in most
/// programs. A polygon without an ear, because it crosses itself or lies on a line, becomes a fan too.
///
/// Cost: O(n^2) for a convex polygon, at most [`MOST_SIGNS`] otherwise.
pub(crate) fn clip_ears(points: &[[f64; 3]], mut emit: impl FnMut([usize; 3])) {
    let plane = project(points);
    let turns_left = |a: usize, b: usize, c: usize| orient2d(plane[a], plane[b], plane[c]);
    let mut ring: Vec<usize> = (0..points.len()).collect();
    let mut signs = 0;
    let (mut at, mut failures) = (1, 0);
    while ring.len() > 3 && failures < ring.len() && signs < MOST_SIGNS {
        let count = ring.len();
        at %= count;
        let (before, tip, after) = (ring[(at + count - 1) % count], ring[at], ring[(at + 1) % count]);
        let covers = |other: usize| {
            turns_left(before, tip, other) >= 0.0
                && turns_left(tip, after, other) >= 0.0
                && turns_left(after, before, other) >= 0.0
        };
        let corners = [before, tip, after].map(|corner| points[corner]);
        signs += count;
        let is_ear = turns_left(before, tip, after) > 0.0
            && !ring.iter().any(|&other| {
                // A corner at the same place as one of the ear's is a bridge to a hole, not an obstacle.
                ![before, tip, after].contains(&other) && !corners.contains(&points[other]) && covers(other)
            });
        if is_ear {
            emit([before, tip, after]);
            ring.remove(at);
            // Staying where the ear was makes the fan of the first corner out of a convex polygon.
            failures = 0;
            if at == ring.len() {
                at = 1;
            }
        } else {
            at += 1;
            failures += 1;
        }
    }
    for pair in ring.windows(2).skip(1) {
        emit([ring[0], pair[0], pair[1]]);
    }
}

/// Projects the polygon to the coordinate plane in which its area is largest, so that it runs counter-clockwise.
fn project(points: &[[f64; 3]]) -> Vec<Coord<f64>> {
    // Twice the area vector (Newell's method), about the first point.
    let mut area = [0.0f64; 3];
    let origin = points[0];
    for pair in points.windows(2) {
        let [p, q] = [pair[0], pair[1]].map(|point| [0, 1, 2].map(|axis| point[axis] - origin[axis]));
        for (axis, component) in area.iter_mut().enumerate() {
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            *component += p[u] * q[v] - p[v] * q[u];
        }
    }
    let mut normal_axis = 2;
    for axis in [1, 0] {
        if area[axis].abs() > area[normal_axis].abs() {
            normal_axis = axis;
        }
    }
    let (u, v) = ((normal_axis + 1) % 3, (normal_axis + 2) % 3);
    let (u, v) = if area[normal_axis] < 0.0 { (v, u) } else { (u, v) };
    points.iter().map(|point| Coord { x: point[u], y: point[v] }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn split(points: &[[f64; 2]]) -> Vec<[usize; 3]> {
        let points: Vec<[f64; 3]> = points.iter().map(|&[x, y]| [x, y, 0.25 * x]).collect();
        let mut triangles = Vec::new();
        clip_ears(&points, |triangle| triangles.push(triangle));
        triangles
    }

    fn area(points: &[[f64; 2]], [a, b, c]: [usize; 3]) -> f64 {
        let [a, b, c] = [a, b, c].map(|k| points[k]);
        0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
    }

    #[test]
    fn clip_ears_of_a_convex_polygon_gives_the_fan_of_its_first_corner() {
        let hexagon = [[2., 0.], [1., 2.], [-1., 2.], [-2., 0.], [-1., -2.], [1., -2.]];
        assert_eq!(split(&hexagon), [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]]);
        let clockwise: Vec<_> = hexagon.iter().rev().copied().collect();
        assert_eq!(split(&clockwise), [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]]);
    }

    #[test]
    fn clip_ears_of_a_non_convex_polygon_covers_its_area_once() {
        // An arrow whose fan from corner 0 would leave it, a comb, and a ring cut open along a bridge.
        let arrow = vec![[0., 0.], [2., 1.], [0., 2.], [1., 1.]];
        let comb = vec![[0., 0.], [5., 0.], [5., 3.], [4., 1.], [3., 3.], [2., 1.], [1., 3.], [0.5, 1.], [0., 3.]];
        let bridged =
            vec![[0., 0.], [4., 0.], [4., 4.], [0., 4.], [0., 0.], [1., 1.], [1., 3.], [3., 3.], [3., 1.], [1., 1.]];
        for (polygon, expected) in [(arrow, 1.0), (comb, 10.0), (bridged, 12.0)] {
            for shift in 0..polygon.len() {
                let mut points = polygon.clone();
                points.rotate_left(shift);
                let triangles = split(&points);
                assert_eq!(triangles.len(), points.len() - 2);
                let areas: Vec<f64> = triangles.iter().map(|&triangle| area(&points, triangle)).collect();
                assert!(areas.iter().all(|&area| area >= 0.0), "{points:?} {triangles:?}");
                assert!((areas.iter().sum::<f64>() - expected).abs() < 1e-12, "{points:?} {triangles:?}");
            }
        }
    }

    #[test]
    fn clip_ears_of_a_degenerate_polygon_keeps_the_number_of_triangles() {
        assert_eq!(split(&[[0., 0.], [1., 0.], [2., 0.], [3., 0.], [1., 0.]]).len(), 3);
        assert_eq!(split(&[[0., 0.], [1., 1.], [1., 0.], [0., 1.]]).len(), 2);
        assert_eq!(split(&[[0., 0.]; 6]).len(), 4);
    }
}
