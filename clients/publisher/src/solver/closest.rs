//! Nearest points of vertices, triangles and edges.

use crate::mesh::Vec3;

/// The point of a triangle with these barycentric coordinates.
pub(super) fn weighted(weights: [f64; 3], corners: [Vec3; 3]) -> Vec3 {
    corners[0] * weights[0] + corners[1] * weights[1] + corners[2] * weights[2]
}

/// Barycentric coordinates of the point of a triangle nearest to `p`.
pub(super) fn closest_on_triangle(p: Vec3, [a, b, c]: [Vec3; 3]) -> [f64; 3] {
    let (ab, ac) = (b - a, c - a);
    let normal = ab.cross(&ac);
    let area = normal.norm_squared();
    if area > 0.0 {
        let v = (p - a).cross(&ac).dot(&normal) / area;
        let w = ab.cross(&(p - a)).dot(&normal) / area;
        if v >= 0.0 && w >= 0.0 && v + w <= 1.0 {
            return [1.0 - v - w, v, w];
        }
    }
    // Outside: the nearest point of the nearest side.
    let on_side = |from: Vec3, to: Vec3| {
        let along = to - from;
        let length = along.norm_squared();
        let t = if length > 0.0 { ((p - from).dot(&along) / length).clamp(0.0, 1.0) } else { 0.0 };
        (t, (from + along * t - p).norm_squared())
    };
    let (t_ab, d_ab) = on_side(a, b);
    let (t_bc, d_bc) = on_side(b, c);
    let (t_ca, d_ca) = on_side(c, a);
    if d_ab <= d_bc && d_ab <= d_ca {
        [1.0 - t_ab, t_ab, 0.0]
    } else if d_bc <= d_ca {
        [0.0, 1.0 - t_bc, t_bc]
    } else {
        [t_ca, 0.0, 1.0 - t_ca]
    }
}

/// Parameters of the nearest points of two edges, if both lie strictly between the ends; `None` for parallel edges.
pub(super) fn closest_on_edges([a, b]: [Vec3; 2], [c, d]: [Vec3; 2]) -> Option<[f64; 2]> {
    let (u, v, r) = (b - a, d - c, a - c);
    let (uu, uv, vv) = (u.norm_squared(), u.dot(&v), v.norm_squared());
    let determinant = uu * vv - uv * uv;
    if determinant <= 1e-6 * uu * vv {
        return None;
    }
    let s = (uv * v.dot(&r) - vv * u.dot(&r)) / determinant;
    let t = (uu * v.dot(&r) - uv * u.dot(&r)) / determinant;
    let inside = |x: f64| x > 0.0 && x < 1.0;
    (inside(s) && inside(t)).then_some([s, t])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn closest_on_triangle_is_nearer_than_any_sample() {
        let corners = [Vec3::new(0.0, 0.0, 0.0), Vec3::new(2.0, 0.3, 0.1), Vec3::new(-0.2, 1.1, 0.4)];
        for p in
            [[0.4, 0.3, 1.0], [-1.0, -1.0, 0.5], [3.0, 0.2, 0.0], [1.0, 1.5, -0.4], [0.9, -0.6, 0.2]].map(Vec3::from)
        {
            let found = (weighted(closest_on_triangle(p, corners), corners) - p).norm();
            let mut best = f64::INFINITY;
            for i in 0..=100 {
                for j in 0..=100 - i {
                    let (v, w) = (f64::from(i) / 100.0, f64::from(j) / 100.0);
                    best = best.min((weighted([1.0 - v - w, v, w], corners) - p).norm());
                }
            }
            assert!(found <= best + 1e-12 && best - found < 0.02, "{found} against {best}");
        }
    }

    #[test]
    fn closest_on_edges_of_crossing_edges_is_their_crossing() {
        let x = Vec3::x();
        let y = Vec3::y();
        let [s, t] = closest_on_edges([-x, x], [-y * 3.0 + Vec3::z(), y + Vec3::z()]).unwrap();
        assert!((s - 0.5).abs() < 1e-12 && (t - 0.75).abs() < 1e-12);
        assert!(closest_on_edges([-x, x], [y, y + x]).is_none());
        assert!(closest_on_edges([x, x * 2.0], [-y, y]).is_none());
    }
}
