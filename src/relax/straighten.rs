//! The last resort where no motion helps: the cloth is drawn flat until nothing intersects any more, and comes back as far as it can.

use std::ops::ControlFlow;

use nalgebra::Point3;

use super::{
    Iteration, Method, RelaxError,
    candidate::rounded,
    damping::Damping,
    domain::Domain,
    membrane::{Factors, Membrane},
    solver::{Best, End, Relaxer},
};
use crate::{
    frame::Frame,
    intersect::{Intersections, Intersector},
    mesh::{Mesh, VertexId},
};

/// Bending stiffnesses, each so much times the one before, from the first on until nothing intersects or the last is reached.
const FIRST_BENDING: f64 = 0.25;
const LAST_BENDING: f64 = 1e5;
const BENDING_STEP: f64 = 4.0;
/// On the way back it falls by this factor in each iteration, down to the least.
const RETURN_STEP: f64 = 0.5;
const LEAST_BENDING: f64 = 1e-3;
/// Local and global steps of an iteration.
const PASSES: usize = 60;
/// A motion is damped where it meets something: half as much in each of so many rounds, then not at all in so many more.
const DAMPING_ROUNDS: [usize; 2] = [2, 10];
/// The way back goes on while it takes away at least this part of the mean square strain.
const WORTHWHILE: f64 = 0.03;

impl Relaxer<'_> {
    /// Straightens the pieces that intersect.
    ///
    /// Cost: some twenty factorisations of a system with the fill of a squared Laplacian, and `PASSES` solutions with each.
    pub(super) fn straighten(
        &mut self,
        best: &mut Best,
        progress: &mut dyn FnMut(&Iteration) -> ControlFlow<()>,
    ) -> Result<End, RelaxError> {
        let input = self.frame.positions().to_vec();
        let mesh = self.mesh;
        let mut domain = Domain::default();
        let faces = self.analyser.last().intersections.segments.iter().flat_map(|segment| segment.faces);
        domain.grow(mesh, faces.flat_map(|face| mesh.face(face)), usize::MAX);
        let membrane = Membrane::of(mesh, &domain, &input);
        let mut positions = input.clone();
        let mut bending = FIRST_BENDING;
        while !self.analyser.last().intersections.edge_face.is_empty() {
            if self.is_exhausted() {
                return Ok(End::Exhausted);
            }
            let Some(factors) = (bending <= LAST_BENDING).then(|| membrane.factorise(bending, &positions)).flatten()
            else {
                return Ok(End::Stuck);
            };
            self.bend(&membrane, &domain, &factors, &mut positions);
            self.set_frame(&positions)?;
            if self.report(Method::Straighten, progress).is_break() {
                return Ok(End::Interrupted);
            }
            bending *= BENDING_STEP;
        }
        *best = Best { merit: 0.0, positions: positions.clone() };
        let mut back = Return::new(mesh, &domain);
        let mut strain = f64::INFINITY;
        while !self.is_exhausted() {
            let now = membrane.strain(&input, &positions);
            if bending <= LEAST_BENDING && now > (1.0 - WORTHWHILE) * strain {
                break;
            }
            strain = now;
            bending = (bending * RETURN_STEP).max(LEAST_BENDING);
            let Some(factors) = membrane.factorise(bending, &positions) else { break };
            let mut wanted = positions.clone();
            self.bend(&membrane, &domain, &factors, &mut wanted);
            if back.approach(&mut positions, &wanted, self.settings.single_precision) {
                self.set_frame(&positions)?;
                if self.report(Method::Straighten, progress).is_break() {
                    return Ok(End::Interrupted);
                }
            }
        }
        *best = Best { merit: 0.0, positions };
        Ok(End::Clean)
    }

    fn bend(&self, membrane: &Membrane<'_>, domain: &Domain, factors: &Factors, positions: &mut [Point3<f64>]) {
        membrane.relax(factors, PASSES, positions);
        if self.settings.single_precision {
            for vertex in domain.vertices() {
                positions[vertex.index()] = rounded(positions[vertex.index()]);
            }
        }
    }
}

/// Moves that keep clean what is clean.
struct Return<'a> {
    mesh: &'a Mesh,
    domain: &'a Domain,
    damping: Damping,
    frame: Frame,
    intersector: Intersector,
    found: Intersections,
    step: Vec<Point3<f64>>,
}

impl<'a> Return<'a> {
    fn new(mesh: &'a Mesh, domain: &'a Domain) -> Self {
        Self {
            mesh,
            domain,
            damping: Damping::default(),
            frame: Frame::default(),
            intersector: Intersector::default(),
            found: Intersections::default(),
            step: Vec::new(),
        }
    }

    /// Goes to `wanted` where nothing is met there, and less far elsewhere. False if no step is left without intersections.
    fn approach(&mut self, positions: &mut [Point3<f64>], wanted: &[Point3<f64>], single_precision: bool) -> bool {
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
                return true;
            }
            let met = self.found.edge_face.iter().flat_map(|found| {
                let ([a, b], [c, d, e]): ([VertexId; 2], _) = (self.mesh.edge(found.edge), self.mesh.face(found.face));
                [a, b, c, d, e].into_iter().filter_map(|vertex| self.domain.local(vertex))
            });
            self.damping.damp(self.mesh, self.domain, met, if round < halving { 0.5 } else { 0.0 });
        }
        false
    }
}
