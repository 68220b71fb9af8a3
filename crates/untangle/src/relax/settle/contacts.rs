//! Contacts: primitives that are near each other, and how near they may come.

use crate::{
    correspond::MaterialPoint,
    frame::Frame,
    mesh::Mesh,
    proximity::{Primitives, ProximityEnd, ProximityPair, ProximitySearch, closest_points},
    relax::{constraints::Constraints, energy::Domain},
};

/// Contacts of a state, with the memory to find them.
#[derive(Debug, Default)]
pub(super) struct Contacts {
    search: ProximitySearch,
    pairs: Vec<ProximityPair>,
    /// One row for each pair that a vertex of the domain belongs to.
    pub(super) rows: Constraints,
}

impl Contacts {
    /// Finds the pairs within `reach_m`, and lets each come as near as `gap_m`; those that are nearer stay where they
    /// are. Neighbours on the surface are no contact unless they are as near as that. False where there are more than
    /// `max_pairs`.
    ///
    /// Cost: that of the search.
    pub(super) fn find(
        &mut self,
        mesh: &Mesh,
        frame: &Frame,
        domain: &Domain,
        [reach_m, gap_m]: [f64; 2],
        max_pairs: usize,
    ) -> bool {
        self.rows.clear();
        if self.search.find(mesh, frame, reach_m, max_pairs, &mut self.pairs) != ProximityEnd::Complete {
            return false;
        }
        for pair in &self.pairs {
            let moves = pair.primitives.vertices(mesh).any(|vertex| domain.local(vertex).is_some());
            if !moves || pair.distance_m > gap_m && are_neighbours(mesh, pair.primitives) {
                continue;
            }
            let closest = closest_points(mesh, frame, pair.primitives);
            let distance_m = closest.offset.norm();
            if distance_m > 0.0 {
                let [own, partner] = [0, 1]
                    .map(|side| MaterialPoint { vertices: closest.vertices[side], weights: closest.weights[side] });
                self.rows.separate(&own, &partner, closest.offset / distance_m, gap_m.min(distance_m) - distance_m);
            }
        }
        true
    }
}

/// Whether an edge joins two primitives.
fn are_neighbours(mesh: &Mesh, primitives: Primitives) -> bool {
    let vertices = primitives.vertices(mesh);
    let num_first = if matches!(primitives, Primitives::VertexFace { .. }) { 1 } else { 2 };
    vertices
        .clone()
        .take(num_first)
        .any(|first| vertices.clone().skip(num_first).any(|second| mesh.edge_between(first, second).is_some()))
}
