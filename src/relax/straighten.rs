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
/// Most local and global steps of an iteration.
const PASSES: usize = 120;
/// A motion is damped where it meets something: half as much in each of so many rounds, then not at all in so many more.
const DAMPING_ROUNDS: [usize; 2] = [2, 10];
/// The way back goes on while it takes away at least this part of the mean square strain.
const WORTHWHILE: f64 = 0.03;

/// How often it is drawn flatter where it comes back crushed or overstretched.
const ATTEMPTS: usize = 3;
/// What comes back so nevertheless at one vertex of this many is no way out.
const LARGEST_SHARE: usize = 100;

impl Relaxer<'_> {
    /// Straightens the pieces that intersect.
    ///
    /// Cost: some twenty factorisations of a system with the fill of a squared Laplacian, and up to `PASSES` solutions with each.
    pub(super) fn straighten(
        &mut self,
        best: &mut Best,
        progress: &mut dyn FnMut(&Iteration) -> ControlFlow<()>,
    ) -> Result<End, RelaxError> {
        let mesh = self.mesh;
        let mut domain = Domain::default();
        let faces = self.analyser.last().intersections.segments.iter().flat_map(|segment| segment.faces);
        domain.grow(mesh, faces.flat_map(|face| mesh.face(face)), usize::MAX);
        let mut flat = self.frame.positions().to_vec();
        // What an attempt has stiffened stays stiff in the next.
        let mut membrane = Membrane::of(mesh, &domain, &flat);
        let mut bending = FIRST_BENDING;
        let mut last = End::Stuck;
        let mut least = (domain.vertices().len() / LARGEST_SHARE, None);
        for _ in 0..ATTEMPTS {
            let mut end = self.flatten(&membrane, &domain, &mut bending, &mut flat, progress)?;
            if end == End::Clean {
                let mut positions = flat.clone();
                end = self.come_back(&mut membrane, &domain, bending / BENDING_STEP, &mut positions, progress)?;
                let is_beyond = |vertex: &&VertexId| self.guard.is_beyond(mesh, &positions, **vertex);
                let num_beyond = domain.vertices().iter().filter(is_beyond).count();
                if num_beyond <= least.0 {
                    least = (num_beyond, Some(positions));
                }
            }
            last = end;
            if end != End::Clean || (least.0 == 0 && least.1.is_some()) {
                break;
            }
            self.set_frame(&flat)?;
        }
        let (_, Some(positions)) = least else {
            return Ok(if last == End::Clean { End::Stuck } else { last });
        };
        *best = Best { merit: 0.0, positions };
        Ok(if last == End::Interrupted { last } else { End::Clean })
    }

    /// Draws what intersects ever flatter, at least once, until nothing does any more.
    fn flatten(
        &mut self,
        membrane: &Membrane<'_>,
        domain: &Domain,
        bending: &mut f64,
        positions: &mut [Point3<f64>],
        progress: &mut dyn FnMut(&Iteration) -> ControlFlow<()>,
    ) -> Result<End, RelaxError> {
        loop {
            if self.is_exhausted() {
                return Ok(End::Exhausted);
            }
            let factors = (*bending <= LAST_BENDING).then(|| membrane.factorise(*bending, positions)).flatten();
            let Some(factors) = factors else { return Ok(End::Stuck) };
            *bending *= BENDING_STEP;
            self.bend(membrane, domain, &factors, positions);
            self.set_frame(positions)?;
            if self.report(Method::Straighten, progress).is_break() {
                return Ok(End::Interrupted);
            }
            if self.analyser.last().intersections.edge_face.is_empty() {
                return Ok(End::Clean);
            }
        }
    }

    /// Goes back towards the shape of the input as far as nothing meets.
    fn come_back(
        &mut self,
        membrane: &mut Membrane<'_>,
        domain: &Domain,
        mut bending: f64,
        positions: &mut [Point3<f64>],
        progress: &mut dyn FnMut(&Iteration) -> ControlFlow<()>,
    ) -> Result<End, RelaxError> {
        let mut back = Return::new(self.mesh, domain);
        let mut strain = f64::INFINITY;
        while !self.is_exhausted() {
            let now = membrane.strain(positions);
            if bending <= LEAST_BENDING && now > (1.0 - WORTHWHILE) * strain {
                break;
            }
            strain = now;
            membrane.stiffen(positions);
            bending = (bending * RETURN_STEP).max(LEAST_BENDING);
            let Some(factors) = membrane.factorise(bending, positions) else { break };
            let mut wanted = positions.to_vec();
            self.bend(membrane, domain, &factors, &mut wanted);
            if back.approach(positions, &wanted, self.settings.single_precision) {
                self.set_frame(positions)?;
                if self.report(Method::Straighten, progress).is_break() {
                    return Ok(End::Interrupted);
                }
            }
        }
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
