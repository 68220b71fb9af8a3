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
    relax::{
        constraints::ShapeLimits,
        energy::{Domain, RestShape},
        settings::ShouldStop,
        sides::SideTracker,
    },
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
    /// What edges and faces may become beside the input, where that is limited.
    limits: Option<(&'a RestShape, ShapeLimits)>,
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
            limits: None,
            damping: Damping::default(),
            holds: vec![0.0; domain.vertices().len()],
            frame: Frame::default(),
            intersector: Intersector::default(),
            found: Intersections::default(),
            step: Vec::new(),
        }
    }

    /// Steps that take no edge and no face beyond their limits, or farther beyond than they are.
    pub(crate) fn within(self, rest: &'a RestShape, limits: ShapeLimits) -> Self {
        Self { limits: Some((rest, limits)), ..self }
    }

    /// Moves `positions`, one for each vertex of the mesh, to `target` where that intersects nothing and takes no
    /// vertex into a body and nothing beyond its limits, and less far elsewhere. False if no such step is left, or the
    /// work is to stop. Cost: one search for intersections for each round of backtracking.
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
            self.make(positions, target, single_precision);
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
            let strained = self.strained(positions);
            let is_free = entered.is_empty() && strained.is_empty();
            if is_free && self.found.edge_face.iter().all(|found| !is_movable(self.mesh, found)) {
                positions.copy_from_slice(&self.step);
                self.update_holds();
                return true;
            }
            let blocked = self.found.edge_face.iter().flat_map(|found| {
                let ([a, b], [c, d, e]): ([VertexId; 2], _) = (self.mesh.edge(found.edge), self.mesh.face(found.face));
                [a, b, c, d, e].into_iter().filter_map(|vertex| self.domain.local(vertex))
            });
            let entered = entered.iter().filter_map(|&vertex| self.domain.local(vertex));
            self.damping.damp(
                self.mesh,
                self.domain,
                blocked.chain(entered).chain(strained),
                BACKTRACKING.factor(round),
            );
        }
        self.update_holds();
        false
    }

    /// Puts the step, as far as damping lets it go, into `self.step`.
    fn make(&mut self, positions: &[Point3<f64>], target: &[Point3<f64>], single_precision: bool) {
        self.step.clear();
        self.step.extend_from_slice(positions);
        for (local, vertex) in self.domain.vertices().iter().enumerate() {
            let before = positions[vertex.index()];
            let point = before + (target[vertex.index()] - before) * self.damping.factor(local);
            self.step[vertex.index()] = stored(point, single_precision);
        }
    }

    /// The vertices of the domain with an edge or a face that the step takes beyond its limit.
    fn strained(&self, positions: &[Point3<f64>]) -> Vec<usize> {
        let Some((rest, limits)) = self.limits else { return Vec::new() };
        let vertices = self.domain.vertices().iter().enumerate();
        let strained =
            vertices.filter(|(_, vertex)| limits.are_violated(self.mesh, rest, positions, &self.step, **vertex));
        strained.map(|(local, _)| local).collect()
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::relax::escape::tests::samples::Pieces;

    #[test]
    fn what_would_be_overstretched_stops_near_its_limit_and_nothing_else_does() {
        let pieces = Pieces::finger(16);
        let (mesh, frame) = pieces.mesh();
        let rest = RestShape::of(&mesh, &frame);
        let mut domain = Domain::default();
        domain.grow(&mesh, mesh.vertex_ids(), 0);
        let half = pieces.positions.len() / 2;
        // The two sheets, far from each other: one is to be three times as wide, the other one to rise.
        let mut positions: Vec<Point3<f64>> = frame.positions().to_vec();
        positions[half..].iter_mut().for_each(|at| at.z += 9.0);
        let moved = |(vertex, at): (usize, &Point3<f64>)| {
            if vertex < half { Point3::new(3.0 * at.x, at.y, at.z) } else { Point3::new(at.x, at.y, at.z + 0.1) }
        };
        let target: Vec<Point3<f64>> = positions.iter().enumerate().map(moved).collect();
        let mut free = positions.clone();
        assert!(CollisionFreeStep::new(&mesh, &domain, &|| false).advance(&mut free, &target, false, None));
        assert_eq!(free, target);
        let mut step = CollisionFreeStep::new(&mesh, &domain, &|| false).within(&rest, ShapeLimits::DESCENT);
        let before = positions.clone();
        assert!(step.advance(&mut positions, &target, false, None));
        assert_eq!(positions[half..], target[half..]);
        let is_violated = |vertex| ShapeLimits::DESCENT.are_violated(&mesh, &rest, &before, &positions, vertex);
        assert!(!mesh.vertex_ids().any(is_violated));
    }
}
