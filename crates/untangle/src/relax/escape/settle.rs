//! Recovery of shape after a descent: back towards the input, as far as nothing intersects.

use nalgebra::Point3;

use crate::{
    geometry::mean_edge_length,
    mesh::VertexId,
    relax::{
        constraints::Constraints,
        energy::ArapEnergy,
        outcome::{Method, RelaxError},
        relaxer::{Progress, Relaxer},
        step::{CollisionFreeStep, DisplacementSolver, SolverBudget, Start},
    },
};

/// The most steps.
const MAX_STEPS: usize = 6;
/// Ends where a step takes back less than this part of displacement and strain.
const MIN_GAIN: f64 = 0.03;
/// The root is the length, in edges, over which a displacement decays.
const STIFFNESS: f64 = 64.0;
/// Edges that change their length by more than this factor get stiffer.
const MAX_STRETCH: f64 = 1.04;
/// Strains below this logarithm may grow.
const SMALL_STRAIN: f64 = 0.08;
/// Gap that is kept where sheets were separated, in mean edge lengths.
const GAP: f64 = 0.2;
const NEWTON_STEPS: usize = 6;

/// Moves a clean state nearer to the input, with all separations held; it stays clean. True if `progress` ended it.
pub(in crate::relax) fn settle(relaxer: &mut Relaxer<'_>, progress: &mut Progress<'_>) -> Result<bool, RelaxError> {
    let Relaxer { mesh, frame, rest, domain, .. } = &mut *relaxer;
    let is_moved = |vertex: &VertexId| rest.position(*vertex) != frame.position(*vertex);
    domain.grow(mesh, mesh.vertex_ids().filter(is_moved), 0);
    let mut change = Change::of(relaxer, relaxer.frame.positions());
    for _ in 0..MAX_STEPS {
        let Some(positions) = step(relaxer) else { break };
        let next = Change::of(relaxer, &positions);
        if !next.improves(change) {
            break;
        }
        let Relaxer { mesh, frame, .. } = &mut *relaxer;
        frame.set(mesh, positions.iter().map(|point| (*point).into()))?;
        if relaxer.note(Method::RecoverShape, 0, 0.0, progress).is_break() {
            return Ok(true);
        }
        let is_slow = |now: f64, before: f64| now > (1.0 - MIN_GAIN) * before;
        if is_slow(next.moved_m, change.moved_m) && is_slow(next.strain, change.strain) {
            break;
        }
        change = next;
    }
    Ok(false)
}

/// How far a state is from the input.
#[derive(Clone, Copy)]
struct Change {
    /// The sum over all vertices that moved.
    moved_m: f64,
    /// The largest logarithm of an edge's length over that in the input.
    strain: f64,
}

impl Change {
    fn of(relaxer: &Relaxer<'_>, positions: &[Point3<f64>]) -> Self {
        let Relaxer { mesh, rest, domain, limits, .. } = relaxer;
        let vertices = domain.vertices();
        let moved_m = vertices.iter().map(|&vertex| (positions[vertex.index()] - rest.position(vertex)).norm()).sum();
        let edges = vertices.iter().flat_map(|&vertex| mesh.vertex_edges(vertex));
        let strain = edges.map(|&edge| limits.strain(mesh, positions, edge)).fold(0.0, f64::max);
        Self { moved_m, strain }
    }

    /// Whether a state is nearer to the input than another, and strains no edge more than that does, or little.
    fn improves(self, other: Self) -> bool {
        let is_nearer = self.moved_m <= other.moved_m || self.strain < other.strain;
        is_nearer && self.strain <= other.strain.max(SMALL_STRAIN)
    }
}

/// One step that intersects nothing; nothing where there is none.
fn step(relaxer: &Relaxer<'_>) -> Option<Vec<Point3<f64>>> {
    let Relaxer { mesh, frame, rest, domain, separated, settings, sides, .. } = relaxer;
    let vertices = domain.vertices();
    let faces = vertices.iter().flat_map(|&vertex| mesh.vertex_faces(vertex)).copied();
    let gap_m = GAP * mean_edge_length(mesh, frame, faces)?;
    let mut constraints = Constraints::default();
    constraints.hold(separated, frame);
    constraints.limit_to_gap(frame, gap_m);
    relaxer.rows_near_bodies().add(GAP, &mut constraints);
    let energy = ArapEnergy { mesh, frame, rest, domain, rest_weight: 1.0, anchor: 1.0 };
    let mut solver = DisplacementSolver::default();
    solver.budget = SolverBudget { newton_steps: NEWTON_STEPS, ..SolverBudget::default() };
    if !solver.solve(&energy, STIFFNESS, MAX_STRETCH, &constraints, Start::Cold, relaxer.should_stop) {
        return None;
    }
    let mut target = frame.positions().to_vec();
    for (&vertex, displacement) in vertices.iter().zip(&solver.displacement) {
        target[vertex.index()] += displacement;
    }
    let mut positions = frame.positions().to_vec();
    let mut step = CollisionFreeStep::new(mesh, domain, relaxer.should_stop);
    step.advance(&mut positions, &target, settings.single_precision, sides.as_ref()).then_some(positions)
}
