//! Collision-free steps towards a target state: a clean state stays clean, and blocked vertices are held afterwards.

use nalgebra::Point3;

use super::{
    damping::{Backtracking, Damping},
    pinned::is_movable,
    precision::stored,
};
use crate::{
    frame::Frame,
    intersect::{EdgeFaceIntersection, Intersections, Intersector},
    mesh::{EdgeId, FaceId, Mesh, VertexId},
    relax::{energy::Domain, settings::ShouldStop, sides::SideTracker},
};

/// Backtracking of vertices whose faces or edges would intersect something.
const BACKTRACKING: Backtracking = Backtracking { halvings: 2, stops: 10 };
/// How strongly a blocked vertex is held: the first strength, its growth after each further step that blocks the
/// vertex, its limit, and its decay after each step that does not.
const FIRST_HOLD: f64 = 0.1;
const HOLD_GROWTH: f64 = 3.0;
const MAX_HOLD: f64 = 100.0;
const HOLD_DECAY: f64 = 0.5;

/// Steps that intersect nothing, with the holds of blocked vertices.
pub(crate) struct CollisionFreeStep<'a> {
    mesh: &'a Mesh,
    domain: &'a Domain,
    should_stop: &'a ShouldStop<'a>,
    damping: Damping,
    holds: Vec<f64>,
    frame: Frame,
    intersector: Intersector,
    found: Intersections,
    step: Vec<Point3<f64>>,
}

impl<'a> CollisionFreeStep<'a> {
    pub(crate) fn new(mesh: &'a Mesh, domain: &'a Domain, should_stop: &'a ShouldStop<'a>) -> Self {
        Self {
            mesh,
            domain,
            should_stop,
            damping: Damping::default(),
            holds: vec![0.0; domain.vertices().len()],
            frame: Frame::default(),
            intersector: Intersector::default(),
            found: Intersections::default(),
            step: Vec::new(),
        }
    }

    /// Moves `positions`, one for each vertex of the mesh, to `target` where that intersects nothing and takes no
    /// vertex into a body, and less far elsewhere. False if no step without intersections is left, or the work is to
    /// stop. Cost: one search for intersections for each round of backtracking.
    pub(crate) fn advance(
        &mut self,
        positions: &mut [Point3<f64>],
        target: &[Point3<f64>],
        single_precision: bool,
        sides: Option<&SideTracker>,
    ) -> bool {
        let inside = |positions: &[Point3<f64>]| {
            sides.map(|sides| sides.wrong_vertices(self.mesh, positions)).unwrap_or_default()
        };
        let before = inside(positions);
        // What is left elsewhere stays, and holds up nothing.
        let mut left = Vec::new();
        self.damping.reset(self.domain.vertices().len());
        for round in 0..=BACKTRACKING.num_rounds() {
            if (self.should_stop)() {
                return false;
            }
            self.step.clear();
            self.step.extend_from_slice(positions);
            for (local, vertex) in self.domain.vertices().iter().enumerate() {
                let before = positions[vertex.index()];
                let point = before + (target[vertex.index()] - before) * self.damping.factor(local);
                self.step[vertex.index()] = stored(point, single_precision);
            }
            if self.frame.set(self.mesh, self.step.iter().map(|point| (*point).into())).is_err() {
                return false;
            }
            self.intersector.intersect(self.mesh, &self.frame, &mut self.found);
            let entered = inside(&self.step).into_iter().filter(|vertex| before.binary_search(vertex).is_err());
            let entered: Vec<VertexId> = entered.collect();
            if round == 0 && !self.found.edge_face.is_empty() {
                left = self.intersections_of(positions);
            }
            self.found.edge_face.retain(|found| is_new(&left, found));
            if entered.is_empty() && self.found.edge_face.iter().all(|found| !is_movable(self.mesh, found)) {
                positions.copy_from_slice(&self.step);
                self.update_holds();
                return true;
            }
            let blocked = self.found.edge_face.iter().flat_map(|found| {
                let ([a, b], [c, d, e]): ([VertexId; 2], _) = (self.mesh.edge(found.edge), self.mesh.face(found.face));
                [a, b, c, d, e].into_iter().filter_map(|vertex| self.domain.local(vertex))
            });
            let entered = entered.iter().filter_map(|&vertex| self.domain.local(vertex));
            self.damping.damp(self.mesh, self.domain, blocked.chain(entered), BACKTRACKING.factor(round));
        }
        self.update_holds();
        false
    }

    /// All pairs of an edge and a face that intersect in a state, in order; none where the numbers don't allow it.
    fn intersections_of(&mut self, positions: &[Point3<f64>]) -> Vec<(EdgeId, FaceId)> {
        if self.frame.set(self.mesh, positions.iter().map(|point| (*point).into())).is_err() {
            return Vec::new();
        }
        let mut found = Intersections::default();
        self.intersector.intersect(self.mesh, &self.frame, &mut found);
        found.edge_face.iter().map(|found| (found.edge, found.face)).collect()
    }

    /// For each vertex of the domain how much it is held where it is, in units of the weights of its triangles.
    pub(crate) fn holds(&self) -> &[f64] {
        &self.holds
    }

    /// Holds blocked vertices more than before, and the others less.
    fn update_holds(&mut self) {
        for (local, hold) in self.holds.iter_mut().enumerate() {
            let missing = 1.0 - self.damping.factor(local);
            if missing > 0.0 {
                *hold = (hold.max(FIRST_HOLD) * (1.0 + HOLD_GROWTH * missing)).min(MAX_HOLD);
            } else {
                *hold *= HOLD_DECAY;
            }
        }
    }
}

/// Whether an intersection is none of those in a list.
fn is_new(left: &[(EdgeId, FaceId)], found: &EdgeFaceIntersection) -> bool {
    left.binary_search(&(found.edge, found.face)).is_err()
}
