//! The last resort where no motion helps: the cloth is drawn flat until nothing intersects any more, and comes back as far as it can.

use std::ops::ControlFlow;

use nalgebra::Point3;

use super::{
    Iteration, Method, RelaxError,
    approach::Approach,
    candidate::{rounded, total},
    clusters::{Tangle, measure},
    domain::Domain,
    membrane::{Factors, Membrane},
    solver::{Best, End, Relaxer},
};
use crate::{
    intersect::{Intersections, Intersector},
    mesh::FaceId,
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
        // A piece without a boundary would be crushed: it stays as it is, and others come apart from it.
        let closed = mesh.closed_pieces();
        let is_open = |face: &FaceId| mesh.piece(*face).is_some_and(|piece| !closed[piece.index()]);
        let faces = self.analyser.last().intersections.segments.iter().flat_map(|segment| segment.faces);
        domain.grow(mesh, faces.filter(is_open).flat_map(|face| mesh.face(face)), usize::MAX);
        if domain.vertices().is_empty() {
            return Ok(End::Stuck);
        }
        let mut flat = self.frame.positions().to_vec();
        // What an attempt has stiffened stays stiff in the next.
        let mut membrane = Membrane::of(mesh, &domain, &flat);
        let mut bending = FIRST_BENDING;
        let mut least = Least { limit: domain.vertices().len() / LARGEST_SHARE, kept: None };
        let mut end = End::Stuck;
        let mut found = Intersections::default();
        for _ in 0..ATTEMPTS {
            end = self.flatten(&membrane, &domain, &mut bending, &mut flat, &mut found, progress)?;
            let mut own = Least { limit: least.limit, kept: None };
            if matches!(end, End::Clean | End::Interrupted) && found.edge_face.is_empty() {
                self.offer(&domain, &flat, &mut own);
            }
            let mut positions = flat.clone();
            if end == End::Clean {
                let bending = bending / BENDING_STEP;
                end = self.come_back(&mut membrane, &domain, bending, &mut positions, &mut own, progress)?;
            }
            // An attempt that was cut short may have come back less far than one that is equally good.
            if own.kept.is_some() && (least.kept.is_none() || own.limit < least.limit || end == End::Clean) {
                least = own;
            }
            if end != End::Clean || self.num_beyond(&domain, &positions) == 0 {
                break;
            }
            // Flatter again, to come back better.
        }
        let Some(positions) = least.kept else {
            return Ok(if end == End::Clean { End::Stuck } else { end });
        };
        *best = Best { merit: 0.0, positions };
        Ok(if end == End::Interrupted { end } else { End::Clean })
    }

    /// Vertices of a domain that are crushed or overstretched.
    fn num_beyond(&self, domain: &Domain, positions: &[Point3<f64>]) -> usize {
        domain.vertices().iter().filter(|vertex| self.guard.is_beyond(self.mesh, positions, **vertex)).count()
    }

    /// Keeps a clean state if it crushes and overstretches no more than those before: of equals the later, which is nearer to the input.
    fn offer(&self, domain: &Domain, positions: &[Point3<f64>], least: &mut Least) {
        let num_beyond = self.num_beyond(domain, positions);
        if num_beyond <= least.limit {
            *least = Least { limit: num_beyond, kept: Some(positions.to_vec()) };
        }
    }

    /// Draws what intersects ever flatter, at least once, until nothing does any more.
    fn flatten(
        &mut self,
        membrane: &Membrane<'_>,
        domain: &Domain,
        bending: &mut f64,
        positions: &mut [Point3<f64>],
        found: &mut Intersections,
        progress: &mut dyn FnMut(&Iteration) -> ControlFlow<()>,
    ) -> Result<End, RelaxError> {
        // Paths and regions are not needed here, and of a tangle that is hopeless they take longer than all the rest.
        let mut intersector = Intersector::default();
        loop {
            if self.is_exhausted() {
                return Ok(End::Exhausted);
            }
            let factors = (*bending <= LAST_BENDING).then(|| membrane.factorise(*bending, positions, &[])).flatten();
            let Some(factors) = factors else { return Ok(End::Stuck) };
            *bending *= BENDING_STEP;
            self.bend(membrane, domain, &factors, positions);
            self.frame.set(self.mesh, positions.iter().map(|point| (*point).into()))?;
            intersector.intersect(self.mesh, &self.frame, found);
            measure(self.mesh, &self.frame, found, &self.first_clusters, &mut self.now);
            let Tangle { num_edge_face, length_m, .. } = total(&self.now);
            if self.note(Method::Straighten, num_edge_face, length_m, progress).is_break() {
                return Ok(End::Interrupted);
            }
            if num_edge_face == 0 {
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
        least: &mut Least,
        progress: &mut dyn FnMut(&Iteration) -> ControlFlow<()>,
    ) -> Result<End, RelaxError> {
        let mut approach = Approach::new(self.mesh, domain);
        let mut strain = f64::INFINITY;
        loop {
            if self.is_exhausted() {
                return Ok(End::Exhausted);
            }
            let now = membrane.strain(positions);
            if bending <= LEAST_BENDING && now > (1.0 - WORTHWHILE) * strain {
                return Ok(End::Clean);
            }
            strain = now;
            membrane.stiffen(positions);
            bending = (bending * RETURN_STEP).max(LEAST_BENDING);
            let Some(factors) = membrane.factorise(bending, positions, approach.holds()) else { return Ok(End::Clean) };
            let mut wanted = positions.to_vec();
            self.bend(membrane, domain, &factors, &mut wanted);
            if approach.go(positions, &wanted, self.settings.single_precision) {
                self.offer(domain, positions, least);
                if self.note(Method::Straighten, 0, 0.0, progress).is_break() {
                    return Ok(End::Interrupted);
                }
            }
        }
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

/// The clean state that crushes and overstretches least.
struct Least {
    /// How many crushed or overstretched vertices another may have to be kept instead.
    limit: usize,
    kept: Option<Vec<Point3<f64>>>,
}

#[cfg(test)]
mod tests;
