//! Shape recovery: what came clean goes back towards the input, as far as nothing intersects.
//!
//! Each step minimises the elastic energy against the shape of the input, with a weak pull of each vertex towards its
//! place there, while primitives that are near each other keep a gap. Lengths of edges weigh far more than bending and
//! shear, as they do in cloth. The step is short enough for the contacts that were found, it intersects nothing new,
//! takes no edge and no face beyond the limits of the descent, or farther beyond, and is taken only if the energy
//! falls.
//!
//! | file | purpose |
//! |---|---|
//! | `contacts` | primitives that are near each other, and how near they may come |
//! | `pull` | how strongly places and shapes are drawn back to those of the input |
//! | `taper` | displacements that end: what moved by next to nothing goes back to where it was |
//!
//! A row uses those above it only.

mod contacts;
mod pull;
mod taper;
#[cfg(test)]
mod tests;

use nalgebra::Point3;

use super::{
    constraints::ShapeLimits,
    outcome::{Method, RelaxError},
    relaxer::{Progress, Relaxer},
    step::{CollisionFreeStep, DisplacementSolver, SolverBudget, Start},
};
use crate::{geometry::mean_edge_length, mesh::VertexId};
use contacts::Contacts;
pub(super) use pull::Pull;
pub(super) use taper::largest_strain;
use taper::taper;

/// Width of the k-ring round what is still tangled that stays as it is.
const LEFT_RINGS: usize = 3;
/// The most steps, and the most failures to make one.
const MAX_STEPS: usize = 40;
/// Ends where two steps take away less than this part of the energy.
const MIN_GAIN: f64 = 0.02;
/// Primitives up to so many mean edge lengths from each other are contacts.
const REACH: f64 = 1.0;
/// Longest displacement of a step as a part of that: two primitives come no nearer than half of their distance.
const TRUST: f64 = 0.5;
/// A step that raises the energy is made again with half the length, down to this part of it.
const LEAST_TRUST: f64 = 0.1;
/// Gap that contacts keep, in mean edge lengths.
const GAP: f64 = 0.1;
/// With more pairs for each vertex contacts are looked for half as far, as often as this: edges are of very different
/// lengths, or surfaces nearly coincide.
const MAX_CONTACTS: usize = 100;
const MAX_HALVINGS: usize = 4;
const BUDGET: SolverBudget = SolverBudget { newton_steps: 12, cg_steps: 100, penalty: 1e4 };

/// Recovers the shape of the input round all vertices that moved, but those beside what is still tangled; then
/// ends displacements that are next to nothing. True if `progress` ended it.
pub(super) fn settle(relaxer: &mut Relaxer<'_>, progress: &mut Progress<'_>) -> Result<bool, RelaxError> {
    let is_ended = recover(relaxer, progress)?;
    if !is_ended && let Some(positions) = taper(relaxer) {
        relaxer.frame.set(relaxer.mesh, positions.iter().map(|point| (*point).into()))?;
    }
    Ok(is_ended)
}

/// The steps. True if `progress` ended them.
fn recover(relaxer: &mut Relaxer<'_>, progress: &mut Progress<'_>) -> Result<bool, RelaxError> {
    relaxer.measure_islands(LEFT_RINGS);
    let Relaxer { mesh, frame, rest, domain, islands, .. } = &mut *relaxer;
    let is_left = |vertex| islands.near(vertex).is_some();
    let is_moved = |vertex: &VertexId| rest.position(*vertex) != frame.position(*vertex) && !is_left(*vertex);
    domain.grow(mesh, mesh.vertex_ids().filter(is_moved), 0);
    let faces = domain.vertices().iter().flat_map(|&vertex| mesh.vertex_faces(vertex)).copied();
    let Some(edge_length_m) = mean_edge_length(mesh, frame, faces) else { return Ok(false) };
    let mut settling = Settling::new(relaxer, edge_length_m);
    let (mut energy, mut trust, mut num_slow) = (f64::INFINITY, TRUST, 0);
    let max_steps = MAX_STEPS.min(relaxer.settings.max_iterations.saturating_sub(relaxer.history.len()));
    for _ in 0..max_steps {
        let moved = settling.step(relaxer, trust, &mut energy);
        if (relaxer.should_stop)() {
            return Ok(true);
        }
        let Some((positions, next)) = moved else {
            trust *= 0.5;
            if trust < LEAST_TRUST * TRUST {
                break;
            }
            continue;
        };
        let Relaxer { mesh, frame, now, .. } = &mut *relaxer;
        frame.set(mesh, positions.iter().map(|point| (*point).into()))?;
        let left =
            (now.iter().map(|tangle| tangle.num_edge_face).sum(), now.iter().map(|tangle| tangle.length_m).sum());
        if relaxer.note(Method::RecoverShape, left.0, left.1, progress).is_break() {
            return Ok(true);
        }
        num_slow = if next > (1.0 - MIN_GAIN) * energy { num_slow + 1 } else { 0 };
        energy = next;
        if num_slow > 1 {
            break;
        }
        trust = (2.0 * trust).min(TRUST);
    }
    Ok(false)
}

/// What stays the same from step to step, with its memory.
struct Settling {
    edge_length_m: f64,
    pull: Pull,
    contacts: Contacts,
    solver: DisplacementSolver,
}

impl Settling {
    fn new(relaxer: &Relaxer<'_>, edge_length_m: f64) -> Self {
        let Relaxer { frame, rest, domain, .. } = relaxer;
        let moved_m = |&vertex: &VertexId| (frame.position(vertex) - rest.position(vertex)).norm();
        let largest_m = domain.vertices().iter().map(moved_m).fold(0.0, f64::max);
        let pull = Pull::of(largest_m, edge_length_m);
        Self { edge_length_m, pull, contacts: Contacts::default(), solver: DisplacementSolver::default() }
    }

    /// One step that lowers the energy, and the energy after it. Sets `before` to the energy before it, if that is not
    /// yet known.
    fn step(&mut self, relaxer: &Relaxer<'_>, trust: f64, before: &mut f64) -> Option<(Vec<Point3<f64>>, f64)> {
        let Relaxer { mesh, frame, rest, domain, settings, .. } = relaxer;
        let energy = self.pull.energy(mesh, frame, rest, domain);
        let reach_m = self.find_contacts(relaxer)?;
        self.solver.budget = BUDGET;
        if !self.solver.solve(
            &energy,
            self.pull.stiffness,
            f64::INFINITY,
            &self.contacts.rows,
            Start::Cold,
            relaxer.should_stop,
        ) {
            return None;
        }
        let largest_m = self.solver.displacement.iter().map(|displacement| displacement.norm()).fold(0.0, f64::max);
        let part = (trust * reach_m / largest_m).min(1.0);
        let mut target = frame.positions().to_vec();
        for (&vertex, displacement) in domain.vertices().iter().zip(&self.solver.displacement) {
            target[vertex.index()] += displacement * part;
        }
        let mut positions = frame.positions().to_vec();
        let mut step = CollisionFreeStep::new(mesh, domain, relaxer.should_stop).within(rest, ShapeLimits::DESCENT);
        if !step.advance(&mut positions, &target, settings.single_precision, relaxer.sides.as_ref()) {
            return None;
        }
        if before.is_infinite() {
            *before = energy.value(self.pull.stiffness, frame.positions());
        }
        let after = energy.value(self.pull.stiffness, &positions);
        (after < *before).then_some((positions, after))
    }

    /// Finds the contacts of the present state; gives back how far they were looked for. Nothing where there are too
    /// many.
    fn find_contacts(&mut self, relaxer: &Relaxer<'_>) -> Option<f64> {
        let Relaxer { mesh, frame, domain, .. } = relaxer;
        let max_contacts = MAX_CONTACTS * mesh.num_vertices();
        for _ in 0..=MAX_HALVINGS {
            let reach_m = REACH * self.edge_length_m;
            if self.contacts.find(mesh, frame, domain, [reach_m, GAP * self.edge_length_m], max_contacts) {
                return Some(reach_m);
            }
            self.edge_length_m *= 0.5;
        }
        None
    }
}
