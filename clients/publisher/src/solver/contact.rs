//! Self-contact: vertices stay off triangles, and edges off edges.
//!
//! Each step takes the side of a pair from the positions at its start, without any memory, so contact preserves a
//! tangle as well. That is why a host needs the mask: pairs with a masked vertex are left out.

use crate::mesh::{Cloth, Vec3};

use super::grid::{Aabb, Grid};

/// One linear inequality, `normal . (sum weight_i x_i) >= gap_m`, over four vertices.
#[derive(Clone, Copy, Debug)]
struct Contact {
    vertices: [u32; 4],
    weights: [f64; 4],
    normal: Vec3,
    gap_m: f64,
}

/// The contacts of one step, and the memory to find them.
#[derive(Clone, Debug)]
pub(super) struct Contacts {
    thickness_m: f64,
    /// Largest distance of two features that may meet within the step.
    range_m: f64,
    cell_m: f64,
    edges: Vec<[u32; 2]>,
    contacts: Vec<Contact>,
    triangle_boxes: Vec<Aabb>,
    edge_boxes: Vec<Aabb>,
    grid: Grid,
    found: Vec<u32>,
}

/// Largest part of the thickness by which features that are too near are separated in one step, so that a tangle whose
/// mask ends does not explode.
const RECOVERY: f64 = 0.1;

impl Contacts {
    pub(super) fn new(cloth: &Cloth, thickness_m: f64, reach_m: f64) -> Self {
        Self {
            thickness_m,
            range_m: thickness_m + reach_m,
            cell_m: 4.0 * reach_m + thickness_m,
            edges: cloth.edges(),
            contacts: Vec::new(),
            triangle_boxes: Vec::new(),
            edge_boxes: Vec::new(),
            grid: Grid::default(),
            found: Vec::new(),
        }
    }

    /// Finds all pairs that may touch within the next step.
    pub(super) fn find(&mut self, cloth: &Cloth, masked: &[bool]) {
        self.contacts.clear();
        if self.thickness_m <= 0.0 {
            return;
        }
        self.find_vertex_triangle(cloth, masked);
        self.find_edge_edge(cloth, masked);
    }

    fn find_vertex_triangle(&mut self, cloth: &Cloth, masked: &[bool]) {
        let at = |vertex: u32| cloth.positions[vertex as usize];
        let off = |vertex: u32| masked.get(vertex as usize).copied().unwrap_or(false);
        self.triangle_boxes.clear();
        self.triangle_boxes.extend(cloth.triangles.iter().map(|triangle| Aabb::of(triangle.map(at), 0.0)));
        self.grid.fill(self.cell_m, &self.triangle_boxes);
        for vertex in (0..).take(cloth.positions.len()).filter(|&vertex| !off(vertex)) {
            let point = at(vertex);
            let aabb = Aabb::of([point], self.range_m);
            self.grid.query(&aabb, &mut self.found);
            for &index in &self.found {
                let triangle @ [a, b, c] = cloth.triangles[index as usize];
                if triangle.contains(&vertex)
                    || triangle.into_iter().any(off)
                    || !aabb.overlaps(&self.triangle_boxes[index as usize])
                {
                    continue;
                }
                let corners = triangle.map(at);
                let near = closest_on_triangle(point, corners);
                let gap: Vec3 = point - weighted(near, corners);
                let fallback = (corners[1] - corners[0]).cross(&(corners[2] - corners[0]));
                let weights = [1.0, -near[0], -near[1], -near[2]];
                self.contacts.extend(contact(
                    [vertex, a, b, c],
                    weights,
                    gap,
                    fallback,
                    self.thickness_m,
                    self.range_m,
                ));
            }
        }
    }

    fn find_edge_edge(&mut self, cloth: &Cloth, masked: &[bool]) {
        let at = |vertex: u32| cloth.positions[vertex as usize];
        let off = |vertex: u32| masked.get(vertex as usize).copied().unwrap_or(false);
        let margin = 0.5 * self.range_m;
        self.edge_boxes.clear();
        self.edge_boxes.extend(self.edges.iter().map(|edge| Aabb::of(edge.map(at), margin)));
        self.grid.fill(self.cell_m, &self.edge_boxes);
        for (index, &[a, b]) in (0_u32..).zip(&self.edges).filter(|(_, edge)| !edge.iter().copied().any(off)) {
            let aabb = self.edge_boxes[index as usize];
            self.grid.query(&aabb, &mut self.found);
            for &other in self.found.iter().filter(|&&other| other > index) {
                let edge @ [c, d] = self.edges[other as usize];
                if edge.contains(&a)
                    || edge.contains(&b)
                    || edge.into_iter().any(off)
                    || !aabb.overlaps(&self.edge_boxes[other as usize])
                {
                    continue;
                }
                let (one, two) = ([a, b].map(at), edge.map(at));
                // Parallel edges and contacts at their ends are covered by vertices and triangles.
                let Some([s, t]) = closest_on_edges(one, two) else { continue };
                let gap = one[0] + (one[1] - one[0]) * s - (two[0] + (two[1] - two[0]) * t);
                let fallback = (one[1] - one[0]).cross(&(two[1] - two[0]));
                let weights = [1.0 - s, s, t - 1.0, -t];
                self.contacts.extend(contact([a, b, c, d], weights, gap, fallback, self.thickness_m, self.range_m));
            }
        }
    }

    /// One sweep over all contacts.
    pub(super) fn project(&self, positions: &mut [Vec3], inverse_masses: &[f64]) {
        for contact in &self.contacts {
            let vertices = contact.vertices.map(|vertex| vertex as usize);
            let mut gap = 0.0;
            let mut weight = 0.0;
            for (&vertex, w) in vertices.iter().zip(contact.weights) {
                gap += w * contact.normal.dot(&positions[vertex]);
                weight += w * w * inverse_masses[vertex];
            }
            if gap >= contact.gap_m || weight <= 0.0 {
                continue;
            }
            let push = contact.normal * ((contact.gap_m - gap) / weight);
            for (&vertex, w) in vertices.iter().zip(contact.weights) {
                positions[vertex] += push * (w * inverse_masses[vertex]);
            }
        }
    }
}

/// A contact along `gap`, or along `fallback` where the gap is zero; `None` where it is wider than the range.
fn contact(
    vertices: [u32; 4],
    weights: [f64; 4],
    gap: Vec3,
    fallback: Vec3,
    thickness_m: f64,
    range_m: f64,
) -> Option<Contact> {
    let distance = gap.norm();
    if distance > range_m {
        return None;
    }
    let normal = if distance > 1e-9 * thickness_m { gap / distance } else { fallback.try_normalize(0.0)? };
    Some(Contact { vertices, weights, normal, gap_m: thickness_m.min(distance + RECOVERY * thickness_m) })
}

fn weighted(weights: [f64; 3], corners: [Vec3; 3]) -> Vec3 {
    corners[0] * weights[0] + corners[1] * weights[1] + corners[2] * weights[2]
}

/// Barycentric coordinates of the point of a triangle nearest to `p`.
fn closest_on_triangle(p: Vec3, [a, b, c]: [Vec3; 3]) -> [f64; 3] {
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
fn closest_on_edges([a, b]: [Vec3; 2], [c, d]: [Vec3; 2]) -> Option<[f64; 2]> {
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
