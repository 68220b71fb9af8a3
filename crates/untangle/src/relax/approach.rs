//! Steps towards a state that keep clean what is clean, and learn where something is in the way.

use nalgebra::Point3;

use super::{candidate::rounded, damping::Damping, domain::Domain};
use crate::{
    frame::Frame,
    intersect::{Intersections, Intersector},
    mesh::{Mesh, VertexId},
};

/// A motion is damped where it meets something: half as much in each of so many rounds, then not at all in so many more.
const DAMPING_ROUNDS: [usize; 2] = [2, 10];
/// What had to stay back is held, from the first strength on so many times more after each step in which it stays back, and else less.
const FIRST_HOLD: f64 = 0.1;
const HOLDING: f64 = 3.0;
const LARGEST_HOLD: f64 = 100.0;
const RELEASE: f64 = 0.5;

/// Moves that keep clean what is clean.
pub(super) struct Approach<'a> {
    mesh: &'a Mesh,
    domain: &'a Domain,
    damping: Damping,
    holds: Vec<f64>,
    frame: Frame,
    intersector: Intersector,
    found: Intersections,
    step: Vec<Point3<f64>>,
}

impl<'a> Approach<'a> {
    pub(super) fn new(mesh: &'a Mesh, domain: &'a Domain) -> Self {
        Self {
            mesh,
            domain,
            damping: Damping::default(),
            holds: vec![0.0; domain.vertices().len()],
            frame: Frame::default(),
            intersector: Intersector::default(),
            found: Intersections::default(),
            step: Vec::new(),
        }
    }

    /// Goes to `wanted` where nothing is met there, and less far elsewhere. False if no step is left without intersections.
    pub(super) fn go(&mut self, positions: &mut [Point3<f64>], wanted: &[Point3<f64>], single_precision: bool) -> bool {
        let [halving, stopping] = DAMPING_ROUNDS;
        self.damping.reset(self.domain.vertices().len());
        for round in 0..=halving + stopping {
            self.step.clear();
            self.step.extend_from_slice(positions);
            for (slot, vertex) in self.domain.vertices().iter().enumerate() {
                let before = positions[vertex.index()];
                let point = before + (wanted[vertex.index()] - before) * self.damping.factor(slot);
                self.step[vertex.index()] = if single_precision { rounded(point) } else { point };
            }
            if self.frame.set(self.mesh, self.step.iter().map(|point| (*point).into())).is_err() {
                return false;
            }
            self.intersector.intersect(self.mesh, &self.frame, &mut self.found);
            if self.found.edge_face.is_empty() {
                positions.copy_from_slice(&self.step);
                self.hold();
                return true;
            }
            let met = self.found.edge_face.iter().flat_map(|found| {
                let ([a, b], [c, d, e]): ([VertexId; 2], _) = (self.mesh.edge(found.edge), self.mesh.face(found.face));
                [a, b, c, d, e].into_iter().filter_map(|vertex| self.domain.local(vertex))
            });
            self.damping.damp(self.mesh, self.domain, met, if round < halving { 0.5 } else { 0.0 });
        }
        self.hold();
        false
    }

    /// For each vertex of the domain how much it is held where it is, in units of what its triangles hold it with.
    pub(super) fn holds(&self) -> &[f64] {
        &self.holds
    }

    /// Holds what had to stay back more than before, and the rest less.
    fn hold(&mut self) {
        for (slot, hold) in self.holds.iter_mut().enumerate() {
            let left = 1.0 - self.damping.factor(slot);
            if left > 0.0 {
                *hold = (hold.max(FIRST_HOLD) * (1.0 + HOLDING * left)).min(LARGEST_HOLD);
            } else {
                *hold *= RELEASE;
            }
        }
    }
}
