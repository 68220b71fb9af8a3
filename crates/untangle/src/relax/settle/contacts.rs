//! Contacts: primitives that are near each other, and how near they may come.

use crate::{
    correspond::MaterialPoint,
    frame::Frame,
    mesh::Mesh,
    proximity::{ProximityEnd, ProximityPair, ProximitySearch, closest_points},
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
    /// are. False where there are more than `max_pairs`.
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
            if pair.primitives.vertices(mesh).all(|vertex| domain.local(vertex).is_none()) {
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
