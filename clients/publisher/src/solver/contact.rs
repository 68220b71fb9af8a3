//! Self-contact: vertices stay off triangles, and edges off edges.
//!
//! Each step takes the side of a pair from the positions at its start, without any memory, so contact preserves a
//! tangle as well. That is why a host needs labels: contacts between the two sides of one tangle are left out. Where it
//! can't use them, it needs the mask: all contacts of a masked vertex are left out.

use rayon::prelude::*;
use untangled_client::ContactFilter;

use crate::mesh::{Cloth, Vec3};

use super::{
    closest::{closest_on_edges, closest_on_triangle, weighted},
    tree::{Aabb, Tree},
};

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
    friction: f64,
    /// Largest distance of two features that may meet within the step.
    range_m: f64,
    edges: Vec<[u32; 2]>,
    contacts: Vec<Contact>,
    triangle_boxes: Vec<Aabb>,
    edge_boxes: Vec<Aabb>,
    triangle_tree: Tree,
    edge_tree: Tree,
}

/// Which contacts a host leaves out.
#[derive(Clone, Copy, Debug)]
pub(super) struct Off<'a> {
    /// All of a vertex.
    pub(super) masked: &'a [bool],
    /// Those between the two sides of one tangle.
    pub(super) filter: Option<&'a ContactFilter>,
}

impl Off<'_> {
    fn is_masked(&self, vertex: u32) -> bool {
        self.masked.get(vertex as usize).copied().unwrap_or(false)
    }

    fn vertex_face(&self, vertex: u32, face: [u32; 3]) -> bool {
        face.into_iter().any(|corner| self.is_masked(corner))
            || self.filter.is_some_and(|filter| filter.vertex_face_is_off(vertex, face))
    }

    fn edge_edge(&self, first: [u32; 2], second: [u32; 2]) -> bool {
        second.into_iter().any(|end| self.is_masked(end))
            || self.filter.is_some_and(|filter| filter.edge_edge_is_off(first, second))
    }
}

/// Largest part of the thickness by which features that are too near are separated in one step, so that a tangle whose
/// mask ends does not explode.
const RECOVERY: f64 = 0.1;
/// Vertices or edges of one task: many for each processor, and enough work for one task to be worth it.
const CHUNK: usize = 1024;

impl Contacts {
    pub(super) fn new(cloth: &Cloth, thickness_m: f64, friction: f64, reach_m: f64) -> Self {
        Self {
            thickness_m,
            friction,
            range_m: thickness_m + reach_m,
            edges: cloth.edges(),
            contacts: Vec::new(),
            triangle_boxes: Vec::new(),
            edge_boxes: Vec::new(),
            triangle_tree: Tree::default(),
            edge_tree: Tree::default(),
        }
    }

    /// Finds all pairs that may touch before the next search: vertices and triangles by vertex, then edges by the lower
    /// one, on all processors, in an order that does not depend on their number.
    pub(super) fn find(&mut self, cloth: &Cloth, off: Off<'_>) {
        self.contacts.clear();
        if self.thickness_m <= 0.0 {
            return;
        }
        let at = |vertex: u32| cloth.positions[vertex as usize];
        let margin = 0.5 * self.range_m;
        self.triangle_boxes.clear();
        self.triangle_boxes.extend(cloth.triangles.iter().map(|triangle| Aabb::of(triangle.map(at), 0.0)));
        self.edge_boxes.clear();
        self.edge_boxes.extend(self.edges.iter().map(|edge| Aabb::of(edge.map(at), margin)));
        rayon::join(|| self.triangle_tree.update(&self.triangle_boxes), || self.edge_tree.update(&self.edge_boxes));
        let this = &*self;
        let mut found = in_chunks(cloth.positions.len(), |vertex, near, contacts| {
            this.find_vertex_triangle(cloth, off, vertex, near, contacts);
        });
        found.append(&mut in_chunks(this.edges.len(), |edge, near, contacts| {
            this.find_edge_edge(cloth, off, edge, near, contacts);
        }));
        for mut contacts in found {
            self.contacts.append(&mut contacts);
        }
    }

    fn find_vertex_triangle(
        &self,
        cloth: &Cloth,
        off: Off<'_>,
        vertex: u32,
        near: &mut Vec<u32>,
        contacts: &mut Vec<Contact>,
    ) {
        if off.is_masked(vertex) {
            return;
        }
        let at = |vertex: u32| cloth.positions[vertex as usize];
        let point = at(vertex);
        self.triangle_tree.query(&self.triangle_boxes, &Aabb::of([point], self.range_m), 0, near);
        for &index in &*near {
            let triangle @ [a, b, c] = cloth.triangles[index as usize];
            if triangle.contains(&vertex) || off.vertex_face(vertex, triangle) {
                continue;
            }
            let corners = triangle.map(at);
            let nearest = closest_on_triangle(point, corners);
            let gap: Vec3 = point - weighted(nearest, corners);
            let fallback = (corners[1] - corners[0]).cross(&(corners[2] - corners[0]));
            let weights = [1.0, -nearest[0], -nearest[1], -nearest[2]];
            contacts.extend(contact([vertex, a, b, c], weights, gap, fallback, self.thickness_m, self.range_m));
        }
    }

    fn find_edge_edge(
        &self,
        cloth: &Cloth,
        off: Off<'_>,
        index: u32,
        near: &mut Vec<u32>,
        contacts: &mut Vec<Contact>,
    ) {
        let first @ [a, b] = self.edges[index as usize];
        if first.into_iter().any(|end| off.is_masked(end)) {
            return;
        }
        let at = |vertex: u32| cloth.positions[vertex as usize];
        self.edge_tree.query(&self.edge_boxes, &self.edge_boxes[index as usize], index + 1, near);
        for &other in &*near {
            let second @ [c, d] = self.edges[other as usize];
            if second.contains(&a) || second.contains(&b) || off.edge_edge(first, second) {
                continue;
            }
            let (one, two) = (first.map(at), second.map(at));
            // Parallel edges and contacts at their ends are covered by vertices and triangles.
            let Some([s, t]) = closest_on_edges(one, two) else { continue };
            let gap = one[0] + (one[1] - one[0]) * s - (two[0] + (two[1] - two[0]) * t);
            let fallback = (one[1] - one[0]).cross(&(two[1] - two[0]));
            let weights = [1.0 - s, s, t - 1.0, -t];
            contacts.extend(contact([a, b, c, d], weights, gap, fallback, self.thickness_m, self.range_m));
        }
    }

    /// One sweep over all contacts. `previous` are the positions at the start of the substep: friction acts against
    /// what has slid since then, by no more than the coefficient times the push (Müller and others 2007).
    pub(super) fn project(&self, positions: &mut [Vec3], previous: &[Vec3], inverse_masses: &[f64]) {
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
            if self.friction > 0.0 {
                let moved = vertices.iter().zip(contact.weights);
                let slid: Vec3 = moved.map(|(&vertex, w)| (positions[vertex] - previous[vertex]) * w).sum();
                let slid = slid - contact.normal * contact.normal.dot(&slid);
                let length = slid.norm();
                if length > 0.0 {
                    let part = (self.friction * (contact.gap_m - gap) / length).min(1.0);
                    for (&vertex, w) in vertices.iter().zip(contact.weights) {
                        positions[vertex] -= slid * (part / weight * w * inverse_masses[vertex]);
                    }
                }
            }
        }
    }
}

/// The contacts that `find` gives for each index below `count`, chunk by chunk.
fn in_chunks(count: usize, find: impl Fn(u32, &mut Vec<u32>, &mut Vec<Contact>) + Sync) -> Vec<Vec<Contact>> {
    let chunks = (0..count.div_ceil(CHUNK)).into_par_iter().map(|chunk| {
        let (mut near, mut contacts) = (Vec::new(), Vec::new());
        for index in CHUNK * chunk..count.min(CHUNK * (chunk + 1)) {
            find(u32::try_from(index).unwrap_or(u32::MAX), &mut near, &mut contacts);
        }
        contacts
    });
    chunks.collect()
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::Sheet;

    #[test]
    fn find_of_a_crumpled_sheet_finds_what_all_pairs_give() {
        let crumple =
            |u: f64, v: f64| Vec3::new(u + 0.02 * (40.0 * v).sin(), v, 0.03 * (50.0 * u).sin() * (37.0 * v).cos());
        let mut cloth = Sheet::new(0.3, 0.3, 0.02).build(3, crumple);
        let [thickness_m, reach_m] = [0.004, 0.01];
        let mut contacts = Contacts::new(&cloth, thickness_m, 0.0, reach_m);
        for _ in 0..3 {
            contacts.find(&cloth, Off { masked: &[], filter: None });
            let at = |vertex: u32| cloth.positions[vertex as usize];
            let (mut pairs, range_m) = (Vec::new(), thickness_m + reach_m);
            for vertex in (0..).take(cloth.positions.len()) {
                let near = |corners: [Vec3; 3]| {
                    (at(vertex) - weighted(closest_on_triangle(at(vertex), corners), corners)).norm()
                };
                let faces =
                    cloth.triangles.iter().filter(|face| !face.contains(&vertex) && near(face.map(at)) <= range_m);
                pairs.extend(faces.map(|&[a, b, c]| [vertex, a, b, c]));
            }
            for (index, &[a, b]) in contacts.edges.iter().enumerate() {
                for &[c, d] in
                    contacts.edges[index + 1..].iter().filter(|edge| !edge.contains(&a) && !edge.contains(&b))
                {
                    let near = |[s, t]: [f64; 2]| (at(a).lerp(&at(b), s) - at(c).lerp(&at(d), t)).norm() <= range_m;
                    if closest_on_edges([at(a), at(b)], [at(c), at(d)]).is_some_and(near) {
                        pairs.push([a, b, c, d]);
                    }
                }
            }
            assert!(pairs.len() > 100);
            assert_eq!(contacts.contacts.iter().map(|contact| contact.vertices).collect::<Vec<_>>(), pairs);
            for position in &mut cloth.positions {
                position.z *= 0.7;
            }
        }
    }

    #[test]
    fn find_leaves_out_what_is_masked_and_what_labels_switch_off() {
        let mut cloth = Sheet::new(0.1, 0.1, 0.02).build(3, |u, v| Vec3::new(u, v, 0.0));
        let num_below = u32::try_from(cloth.positions.len()).unwrap();
        cloth.append(Sheet::new(0.1, 0.1, 0.02).build(4, |u, v| Vec3::new(u, v, 0.003)), Vec3::zeros());
        let mut contacts = Contacts::new(&cloth, 0.004, 0.0, 0.001);
        let mut vertices = |masked: &[bool], filter: Option<&ContactFilter>| {
            contacts.find(&cloth, Off { masked, filter });
            contacts.contacts.iter().map(|contact| contact.vertices).collect::<Vec<_>>()
        };
        let all = vertices(&[], None);
        let mut filter = ContactFilter::new(cloth.positions.len());
        filter.set((0..2 * num_below).map(|vertex| (vertex, if vertex < num_below { 1 } else { 2 })));
        assert!(!all.is_empty() && vertices(&[], Some(&filter)).is_empty());
        filter.set((0..num_below).map(|vertex| (vertex, 1)));
        assert_eq!(vertices(&[], Some(&filter)), all);
        let masked: Vec<bool> = cloth.positions.iter().map(|position| position.x > 0.05).collect();
        let left: Vec<_> =
            all.iter().filter(|four| four.iter().all(|&vertex| !masked[vertex as usize])).copied().collect();
        assert!(!left.is_empty() && left.len() < all.len());
        assert_eq!(vertices(&masked, None), left);
    }
}
