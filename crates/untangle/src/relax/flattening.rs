//! The last resort where no trial helps: a flattening (unfolding) flow until nothing intersects, then shape recovery.

use nalgebra::Point3;

use super::{
    energy::{Domain, FlatteningEnergy, FlatteningSystem},
    outcome::{BestState, End, Method, RelaxError},
    relaxer::{Progress, Relaxer},
    step::{CollisionFreeStep, Tangle, measure, stored, total},
};
use crate::{
    intersect::{Intersections, Intersector},
    mesh::FaceId,
};

/// The bending stiffness of the flow grows from the first value by a factor for each iteration, until nothing
/// intersects or the last value is passed.
const FIRST_BENDING: f64 = 0.25;
const LAST_BENDING: f64 = 1e5;
const BENDING_STEP: f64 = 4.0;
/// During shape recovery it falls by a factor for each iteration, down to the least value.
const RECOVERY_STEP: f64 = 0.5;
const MIN_BENDING: f64 = 1e-3;
/// Most local and global steps of an iteration.
const MAX_STEPS: usize = 120;
/// Shape recovery goes on while it removes at least this part of the mean square strain.
const MIN_PROGRESS: f64 = 0.03;
/// The flow is given up where so many iterations in a row leave more than this part of the intersections there were at
/// least.
const MAX_STALLED: usize = 2;
const STALLED: f64 = 0.97;
/// How often the flow goes on to a flatter state where shape recovery ends crushed or overstretched.
const MAX_ATTEMPTS: usize = 3;
/// A state is accepted with at most one crushed or overstretched vertex for this many vertices of the domain.
const VERTICES_PER_VIOLATION: usize = 100;

/// Flattens the pieces that intersect, and recovers their shape.
///
/// Cost: some twenty factorisations of a system with the fill of a squared Laplacian, and up to `MAX_STEPS` solutions
/// with each.
pub(super) fn flatten(
    relaxer: &mut Relaxer<'_>,
    best: &mut BestState,
    progress: &mut Progress<'_>,
) -> Result<End, RelaxError> {
    let domain = intersecting_pieces(relaxer);
    if domain.vertices().is_empty() {
        return Ok(End::Stuck);
    }
    let mut least = LeastViolated { limit: domain.vertices().len() / VERTICES_PER_VIOLATION, kept: None };
    let mut flow = Flow::new(relaxer, &domain);
    let mut end = End::Stuck;
    for _ in 0..MAX_ATTEMPTS {
        let mut own = LeastViolated { limit: least.limit, kept: None };
        let num_violated;
        (end, num_violated) = flow.attempt(&mut own, progress)?;
        // An attempt that was cut short may have recovered less than one that violates as few limits.
        if own.kept.is_some() && (least.kept.is_none() || own.limit < least.limit || end == End::Clean) {
            least = own;
        }
        if end != End::Clean || num_violated == 0 {
            break;
        }
    }
    let Some(positions) = least.kept else {
        return Ok(if end == End::Clean { End::Stuck } else { end });
    };
    *best = BestState { merit: 0.0, positions };
    Ok(if end == End::Interrupted { end } else { End::Clean })
}

/// All vertices of the pieces that intersect. A piece without a boundary would be crushed: it is left out, and others
/// separate from it.
fn intersecting_pieces(relaxer: &Relaxer<'_>) -> Domain {
    let mesh = relaxer.mesh;
    let closed = mesh.closed_pieces();
    let is_open = |face: &FaceId| mesh.piece(*face).is_some_and(|piece| !closed[piece.index()]);
    let faces = relaxer.analyser.last().intersections.segments.iter().flat_map(|segment| segment.faces);
    let mut domain = Domain::default();
    domain.grow(mesh, faces.filter(is_open).flat_map(|face| mesh.face(face)), usize::MAX);
    domain
}

/// The flow over a domain, from one attempt to the next.
struct Flow<'a, 'm> {
    relaxer: &'a mut Relaxer<'m>,
    domain: &'a Domain,
    /// Triangles that one attempt has made stiffer stay so in the next.
    energy: FlatteningEnergy<'a>,
    bending: f64,
    /// The flattest state so far: one position for each vertex of the mesh.
    flat: Vec<Point3<f64>>,
    found: Intersections,
    /// Whether that state intersects nothing that a motion can change.
    is_clean: bool,
}

impl<'a, 'm> Flow<'a, 'm> {
    fn new(relaxer: &'a mut Relaxer<'m>, domain: &'a Domain) -> Self {
        let flat = relaxer.frame.positions().to_vec();
        let energy = FlatteningEnergy::of(relaxer.mesh, domain, &flat);
        Self { relaxer, domain, energy, bending: FIRST_BENDING, flat, found: Intersections::default(), is_clean: false }
    }

    /// Goes on to a flatter state, and recovers from there. Offers all clean states to `least`; gives back how it
    /// ended, and how many vertices of the last state are crushed or overstretched.
    fn attempt(&mut self, least: &mut LeastViolated, progress: &mut Progress<'_>) -> Result<(End, usize), RelaxError> {
        let mut end = self.flatten(progress)?;
        let num_violated = self.num_violated(&self.flat);
        if matches!(end, End::Clean | End::Interrupted) && self.is_clean {
            least.offer(&self.flat, num_violated);
        }
        if end != End::Clean {
            return Ok((end, num_violated));
        }
        let mut positions = self.flat.clone();
        end = self.recover(&mut positions, least, progress);
        Ok((end, self.num_violated(&positions)))
    }

    /// Vertices that are crushed or overstretched.
    fn num_violated(&self, positions: &[Point3<f64>]) -> usize {
        self.relaxer.limits.num_violated(self.relaxer.mesh, positions, self.domain)
    }

    /// Flattens the cloth with ever more bending stiffness, at least once, until nothing intersects.
    fn flatten(&mut self, progress: &mut Progress<'_>) -> Result<End, RelaxError> {
        // Paths and regions are not needed here, and of a large tangle they take longer than all the rest.
        let mut intersector = Intersector::default();
        let (mut least, mut stalled) = (f64::INFINITY, 0);
        loop {
            if self.relaxer.is_exhausted() {
                return Ok(End::Exhausted);
            }
            let is_last = self.bending > LAST_BENDING;
            let system = if is_last { None } else { self.energy.factorise(self.bending, &self.flat, &[]) };
            let Some(system) = system else { return Ok(End::Stuck) };
            self.bending *= BENDING_STEP;
            self.is_clean = false;
            minimise(&self.energy, self.domain, &system, self.relaxer, &mut self.flat);
            if (self.relaxer.should_stop)() {
                return Ok(End::Interrupted);
            }
            let Relaxer { mesh, frame, sides, first_islands, now, .. } = &mut *self.relaxer;
            frame.set(mesh, self.flat.iter().map(|point| (*point).into()))?;
            intersector.intersect(mesh, frame, &mut self.found);
            measure(mesh, frame, &self.found, sides.as_ref(), first_islands, now);
            let tangle @ Tangle { num_edge_face, length_m, .. } = total(now);
            self.is_clean = tangle.is_none();
            if self.relaxer.note(Method::Flatten, num_edge_face, length_m, progress).is_break() {
                return Ok(End::Interrupted);
            }
            if self.is_clean {
                return Ok(End::Clean);
            }
            #[expect(clippy::cast_precision_loss, reason = "a count")]
            let left = num_edge_face as f64;
            stalled = if left > STALLED * least { stalled + 1 } else { 0 };
            least = least.min(left);
            if stalled >= MAX_STALLED {
                return Ok(End::Stuck);
            }
        }
    }

    /// Shape recovery: collision-free steps towards states with ever less bending stiffness.
    fn recover(
        &mut self,
        positions: &mut [Point3<f64>],
        least: &mut LeastViolated,
        progress: &mut Progress<'_>,
    ) -> End {
        let single_precision = self.relaxer.settings.single_precision;
        let mut step = CollisionFreeStep::new(self.relaxer.mesh, self.domain, self.relaxer.should_stop);
        let mut bending = self.bending / BENDING_STEP;
        let mut strain = f64::INFINITY;
        loop {
            if self.relaxer.is_exhausted() {
                return End::Exhausted;
            }
            let now = self.energy.mean_square_strain(positions);
            if bending <= MIN_BENDING && now > (1.0 - MIN_PROGRESS) * strain {
                return End::Clean;
            }
            strain = now;
            self.energy.stiffen(positions);
            bending = (bending * RECOVERY_STEP).max(MIN_BENDING);
            let Some(system) = self.energy.factorise(bending, positions, step.holds()) else { return End::Clean };
            let mut target = positions.to_vec();
            minimise(&self.energy, self.domain, &system, self.relaxer, &mut target);
            if (self.relaxer.should_stop)() {
                return End::Interrupted;
            }
            if step.advance(positions, &target, single_precision, self.relaxer.sides.as_ref()) {
                least.offer(positions, self.num_violated(positions));
                if self.relaxer.note(Method::Flatten, 0, 0.0, progress).is_break() {
                    return End::Interrupted;
                }
            }
        }
    }
}

/// Minimises the energy, and rounds where asked for.
fn minimise(
    energy: &FlatteningEnergy<'_>,
    domain: &Domain,
    system: &FlatteningSystem,
    relaxer: &Relaxer<'_>,
    positions: &mut [Point3<f64>],
) {
    energy.minimise(system, MAX_STEPS, positions, relaxer.should_stop);
    for vertex in domain.vertices() {
        positions[vertex.index()] = stored(positions[vertex.index()], relaxer.settings.single_precision);
    }
}

/// The clean state that crushes and overstretches least.
struct LeastViolated {
    /// How many crushed or overstretched vertices another may have to be kept instead.
    limit: usize,
    kept: Option<Vec<Point3<f64>>>,
}

impl LeastViolated {
    /// Keeps a clean state if it crushes and overstretches no more vertices than those before: of equals the later,
    /// which is nearer to the rest shape.
    fn offer(&mut self, positions: &[Point3<f64>], num_violated: usize) {
        if num_violated <= self.limit {
            *self = Self { limit: num_violated, kept: Some(positions.to_vec()) };
        }
    }
}

#[cfg(test)]
mod tests;
