//! A step that intersects nothing and strains no edge too far: shorter where it would.

use nalgebra::{Point3, Vector3};

use crate::{
    frame::Frame,
    intersect::{Intersections, Intersector},
    mesh::{EdgeId, Mesh, VertexId},
    relax::{
        energy::{ArapEnergy, Domain, RestShape},
        settings::ShouldStop,
        step::{Backtracking, Damping, stored},
    },
};

/// No edge may get longer than this many times its length at rest by a step, or shorter than the inverse.
const MAX_STRETCH: f64 = 1.25;
/// Backtracking of vertices that would intersect something or be strained too far.
const BACKTRACKING: Backtracking = Backtracking { halvings: 3, stops: 6 };

/// The step, with its memory.
#[derive(Debug, Default)]
pub(super) struct ClearStep {
    damping: Damping,
    frame: Frame,
    intersector: Intersector,
    found: Intersections,
    blocked: Vec<usize>,
}

impl ClearStep {
    /// Moves the vertices of the domain by a displacement each, or less far. Displacements up to `least_m` are not
    /// made, so that what need not move keeps its bits. Nothing where no step is left, or the work is to stop.
    ///
    /// Cost: one search for intersections for each round of backtracking.
    pub(super) fn make(
        &mut self,
        energy: &ArapEnergy<'_>,
        displacement: &[Vector3<f64>],
        least_m: f64,
        single_precision: bool,
        should_stop: &ShouldStop<'_>,
    ) -> Option<Vec<Point3<f64>>> {
        let ArapEnergy { mesh, frame, domain, rest, .. } = *energy;
        let before = frame.positions();
        self.damping.reset(domain.vertices().len());
        for round in 0..=BACKTRACKING.num_rounds() {
            if should_stop() {
                return None;
            }
            let mut after = before.to_vec();
            for (local, &vertex) in domain.vertices().iter().enumerate() {
                let moved = displacement[local] * self.damping.factor(local);
                if moved.norm() > least_m {
                    after[vertex.index()] = stored(before[vertex.index()] + moved, single_precision);
                }
            }
            self.frame.set(mesh, after.iter().map(|point| (*point).into())).ok()?;
            self.find_blocked(mesh, domain, rest, before, &after);
            if self.blocked.is_empty() {
                return Some(after);
            }
            self.damping.damp(mesh, domain, self.blocked.iter().copied(), BACKTRACKING.factor(round));
        }
        None
    }

    /// Vertices of the domain that intersect something after the step, or have an edge that is strained too far.
    fn find_blocked(
        &mut self,
        mesh: &Mesh,
        domain: &Domain,
        rest: &RestShape,
        before: &[Point3<f64>],
        after: &[Point3<f64>],
    ) {
        self.blocked.clear();
        self.intersector.intersect(mesh, &self.frame, &mut self.found);
        for found in &self.found.edge_face {
            let vertices = mesh.edge(found.edge).into_iter().chain(mesh.face(found.face));
            self.blocked.extend(vertices.filter_map(|vertex| domain.local(vertex)));
        }
        let is_strained = |vertex: VertexId| {
            mesh.vertex_edges(vertex).iter().any(|&edge| is_overstretched(mesh, rest, [before, after], edge))
        };
        let strained = domain.vertices().iter().enumerate().filter(|(_, vertex)| is_strained(**vertex));
        self.blocked.extend(strained.map(|(local, _)| local));
        self.blocked.sort_unstable();
        self.blocked.dedup();
    }
}

/// Whether an edge is beyond its limit after a step, and farther than before it.
fn is_overstretched(mesh: &Mesh, rest: &RestShape, states: [&[Point3<f64>]; 2], edge: EdgeId) -> bool {
    let [a, b] = mesh.edge(edge);
    let at_rest = (rest.position(b) - rest.position(a)).norm();
    let [then, now] = states.map(|state| (state[b.index()] - state[a.index()]).norm());
    let too_long = at_rest > 0.0 && now > MAX_STRETCH * at_rest && now > then;
    too_long || (now * MAX_STRETCH < at_rest && now < then)
}
