//! Polygons split into triangles.
//!
//! No crate for this (`earcut`, `spade` and others) gives the triangles that a plain clipping of ears gives, and the
//! triangles decide what a repair does: so the plain method is the rule here, and [`fast`] follows it to the triangle.

mod corner_tree;
mod fast;

use robust::{Coord, orient2d};

/// Up to this number of corners the plain search is as fast as the tree.
const MOST_CORNERS_OF_PLAIN_SEARCH: usize = 64;

/// Splits one polygon of `n` corners into `n - 2` triangles of its orientation, each emitted as three corner numbers.
///
/// Ears are clipped in the order of the corners, in the coordinate plane in which the polygon's area is largest, and
/// decided by exact signs (Shewchuk 1997). A convex polygon so becomes the fan of its first corner, as in most
/// programs. What remains of a polygon without an ear, because it crosses itself or lies on a line, becomes a fan too.
///
/// Cost: O(n log n) for ordinary polygons; bounded for all others, see [`fast::clip`].
pub(crate) fn clip_ears(points: &[[f64; 3]], mut emit: impl FnMut([usize; 3])) {
    let plane = project(points);
    let polygon = Polygon { points, plane: &plane };
    if points.len() <= MOST_CORNERS_OF_PLAIN_SEARCH {
        clip_plainly(polygon, &mut emit);
    } else {
        fast::clip(polygon, &mut emit);
    }
}

/// The corners of a polygon, in space and in the plane in which it runs counter-clockwise.
#[derive(Clone, Copy, Debug)]
struct Polygon<'a> {
    points: &'a [[f64; 3]],
    plane: &'a [Coord<f64>],
}

impl Polygon<'_> {
    fn turns_left(self, a: usize, b: usize, c: usize) -> bool {
        orient2d(self.plane[a], self.plane[b], self.plane[c]) > 0.0
    }

    /// Whether a corner keeps three others from being an ear: it lies in their triangle or on its border. A corner at
    /// the same place as one of the ear's is a bridge to a hole, not an obstacle.
    fn obstructs(self, other: usize, ear: [usize; 3]) -> bool {
        let [a, b, c] = ear;
        let is_left = |a: usize, b: usize| orient2d(self.plane[a], self.plane[b], self.plane[other]) >= 0.0;
        !ear.contains(&other)
            && !ear.iter().any(|&corner| self.points[corner] == self.points[other])
            && is_left(a, b)
            && is_left(b, c)
            && is_left(c, a)
    }
}

/// Clips ears by looking at all corners for each. Cost: O(n^2) for a convex polygon, O(n^3) for others.
fn clip_plainly(polygon: Polygon<'_>, emit: &mut dyn FnMut([usize; 3])) {
    let mut ring: Vec<usize> = (0..polygon.points.len()).collect();
    let (mut at, mut failures) = (1, 0);
    while ring.len() > 3 && failures < ring.len() {
        let count = ring.len();
        at %= count;
        let ear = [ring[(at + count - 1) % count], ring[at], ring[(at + 1) % count]];
        let [before, tip, after] = ear;
        if polygon.turns_left(before, tip, after) && !ring.iter().any(|&other| polygon.obstructs(other, ear)) {
            emit(ear);
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
    emit_fan(&ring, emit);
}

/// The triangles of the first corner with all edges of the ring that do not touch it.
fn emit_fan(ring: &[usize], emit: &mut dyn FnMut([usize; 3])) {
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

    /// A random polygon of some kind: star-shaped, a comb, a walk that crosses itself, points on a small lattice.
    fn random_polygon(kind: u32, count: u32, next: &mut impl FnMut() -> f64) -> Vec<[f64; 2]> {
        (0..count)
            .map(|k| {
                let turn = f64::from(k) / f64::from(count) * std::f64::consts::TAU;
                match kind {
                    0 => {
                        let radius = 0.2 + next();
                        [radius * turn.cos(), radius * turn.sin()]
                    }
                    1 => [f64::from(k) * 0.5, if k == 0 || k + 1 == count { -1.0 } else { next() }],
                    2 => [next(), next()],
                    3 => [(next() * 5.0).floor(), (next() * 5.0).floor()],
                    4 => [turn.cos(), turn.sin()],
                    _ => [(turn.cos() * 9.0).round(), (turn.sin() * 9.0).round()],
                }
            })
            .collect()
    }

    #[test]
    fn fast_clip_of_random_polygons_gives_the_triangles_of_the_plain_search() {
        let mut state = 3u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            f64::from(u32::try_from(state >> 32).unwrap()) / f64::from(u32::MAX)
        };
        let mut num_ears = 0;
        for round in 0..600 {
            let count = 4 + round % 97;
            let polygon = random_polygon(round % 6, count, &mut next);
            for reversed in [false, true] {
                let mut points: Vec<[f64; 3]> = polygon.iter().map(|&[x, y]| [x, 0.5 * x, y]).collect();
                if reversed {
                    points.reverse();
                }
                let plane = project(&points);
                let polygon = Polygon { points: &points, plane: &plane };
                let (mut plain, mut fast) = (Vec::new(), Vec::new());
                clip_plainly(polygon, &mut |triangle| plain.push(triangle));
                fast::clip(polygon, &mut |triangle| fast.push(triangle));
                assert_eq!(plain, fast, "{points:?}");
                num_ears += plain.iter().filter(|triangle| triangle[0] != 0).count();
            }
        }
        assert!(num_ears > 10_000, "{num_ears}");
    }

    #[test]
    fn clip_ears_of_100000_corners_of_any_shape_ends() {
        let mut state = 5u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            f64::from(u32::try_from(state >> 32).unwrap()) / f64::from(u32::MAX)
        };
        for kind in 0..6 {
            let mut polygon = random_polygon(kind, 100_000, &mut next);
            for _ in 0..2 {
                let triangles = split(&polygon);
                assert_eq!(triangles.len(), 99_998);
                if [0, 1, 4].contains(&kind) {
                    // Simple polygons: all triangles are ears.
                    assert!(triangles.iter().all(|&triangle| area(&polygon, triangle).abs() > 0.0), "kind {kind}");
                    let signed: f64 = triangles.iter().map(|&triangle| area(&polygon, triangle)).sum();
                    let sum: f64 = triangles.iter().map(|&triangle| area(&polygon, triangle).abs()).sum();
                    assert!((sum - signed.abs()).abs() <= 1e-9 * sum, "kind {kind}: {sum} {signed}");
                }
                polygon.reverse();
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
