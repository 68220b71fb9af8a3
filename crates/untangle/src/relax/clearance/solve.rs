//! The iterations.

use std::{collections::BTreeMap, ops::ControlFlow};

use nalgebra::Point3;

use super::{
    obstacles::{Obstacles, held},
    outcome::{Clearance, ClearanceObstacle, Left, places},
    required::Required,
    rows::add_row,
    step::ClearStep,
    tangled::tangled_vertices,
};
use crate::{
    frame::Frame,
    mesh::{Mesh, VertexId},
    proximity::{Primitives, ProximityEnd, ProximityPair, ProximitySearch},
    relax::{
        constraints::Constraints,
        energy::{ArapEnergy, Domain, RestShape},
        outcome::{Iteration, RelaxError},
        settings::{RelaxSettings, ShouldStop},
        step::{DisplacementSolver, SolverBudget, Start},
    },
    sparse_map::SparseMap,
};

/// The root is the length, in edges, over which a displacement decays.
const STIFFNESS: f64 = 4.0;
/// Rings round the constraints that may move: three times that length.
const DOMAIN_RINGS: usize = 6;
/// Edges that change their length by more than this factor get stiffer.
const MAX_STRETCH: f64 = 1.05;
const BUDGET: SolverBudget = SolverBudget { newton_steps: 8, cg_steps: 60, penalty: 2000.0 };
/// A pair that so many iterations set no further apart, by this part of the gap, is given up.
const PATIENCE: usize = 6;
const MIN_GAIN: f64 = 0.01;
/// Displacements up to this part of the gap are not made.
const LEAST_MOTION: f64 = 1e-4;
/// Most pairs that are looked at together.
const MAX_PAIRS: usize = 4_000_000;

/// The caller's function that is told of each iteration, and may end the work.
type Progress<'p> = dyn FnMut(&Iteration) -> ControlFlow<()> + 'p;

/// Moves vertices until no two primitives without a common vertex are nearer than
/// `gap_m`, in double precision and after rounding to single precision, or nothing helps any more. No state on the way
/// has an intersection that `positions` does not have. `positions` are in metres, `num_vertices x 3`; they are the rest
/// shape. Of `settings` the largest number of iterations and the precision are used. `progress` and `should_stop` are
/// those of [`relax_until`](crate::relax::relax_until).
///
/// Pairs that can't be set apart are found out and left alone, each with its reason; the others go on. What intersects,
/// or is on the wrong side of a body or a layer, stays as it is with two rings round it.
///
/// Cost: an iteration takes a search for pairs, some factorisations of a sparse system over the vertices near the pairs
/// below the gap, and up to ten searches for intersections.
///
/// # Errors
/// [`RelaxError`] for positions that no frame accepts.
pub fn open_gap(
    mesh: &Mesh,
    positions: &[[f64; 3]],
    gap_m: f64,
    settings: &RelaxSettings,
    progress: &mut Progress<'_>,
    should_stop: &ShouldStop<'_>,
) -> Result<Clearance, RelaxError> {
    let frame = Frame::new(mesh, positions)?;
    let input = frame.clone();
    let tangled = tangled_vertices(mesh, &frame);
    let held;
    let mesh = if tangled.keys().is_empty() {
        mesh
    } else {
        held = mesh.with_pins(tangled.keys().iter().copied());
        &held
    };
    let mut solver = Solver {
        required: Required::new(mesh, &frame, gap_m, settings.single_precision),
        rest: RestShape::of(mesh, &frame),
        mesh,
        gap_m,
        settings,
        should_stop,
        frame,
        input: &input,
        tangled,
        search: ProximitySearch::default(),
        pairs: Vec::new(),
        obstacles: Obstacles::default(),
        known: BTreeMap::new(),
        displacement: DisplacementSolver::default(),
        step: ClearStep::default(),
        history: Vec::new(),
    };
    solver.displacement.budget = BUDGET;
    let interrupted = solver.run(progress)?;
    Ok(solver.finish(positions, interrupted))
}

/// What is known of a pair that is below the gap.
#[derive(Clone, Copy, Debug)]
struct Known {
    obstacle: Option<ClearanceObstacle>,
    /// The largest distance so far, and the iteration that reached it.
    best_m: f64,
    since: usize,
}

struct Solver<'a> {
    mesh: &'a Mesh,
    gap_m: f64,
    settings: &'a RelaxSettings,
    should_stop: &'a ShouldStop<'a>,
    required: Required,
    rest: RestShape,
    frame: Frame,
    input: &'a Frame,
    tangled: SparseMap<VertexId, ()>,
    search: ProximitySearch,
    /// All pairs within the horizon in the present state.
    pairs: Vec<ProximityPair>,
    obstacles: Obstacles,
    known: BTreeMap<Primitives, Known>,
    displacement: DisplacementSolver,
    step: ClearStep,
    history: Vec<Iteration>,
}

/// How far a state is from its gap: the number of pairs that are too close, and by how much together.
type Rank = (usize, f64);

impl Solver<'_> {
    /// Iterates; true if the caller ended it. The best state is in the frame then.
    fn run(&mut self, progress: &mut Progress<'_>) -> Result<bool, RelaxError> {
        let mut best: (Rank, Vec<Point3<f64>>) = ((usize::MAX, f64::INFINITY), Vec::new());
        let interrupted = loop {
            let is_small_enough = self.look();
            let rank = self.rank();
            if rank < best.0 {
                best = (rank, self.frame.positions().to_vec());
            }
            if !is_small_enough {
                break false;
            }
            let iteration = self.history.len();
            if iteration > 0 && progress(&self.history[iteration - 1]).is_break() {
                break true;
            }
            let Some(rows) = self.rows(iteration) else { break true };
            if rows.len() == 0 || iteration >= self.settings.max_iterations {
                break false;
            }
            let next = self.advance(&rows);
            if (self.should_stop)() {
                break true;
            }
            if let Some(positions) = next {
                self.frame.set(self.mesh, positions.iter().map(|point| (*point).into()))?;
            }
            let num_pairs_below = self.num_below();
            self.history.push(Iteration::of_gap(num_pairs_below));
        };
        self.frame.set(self.mesh, best.1.iter().map(|point| (*point).into()))?;
        self.look();
        Ok(interrupted)
    }

    /// Finds all pairs within the horizon; false where there are too many.
    fn look(&mut self) -> bool {
        let Self { mesh, frame, search, required, pairs, .. } = self;
        search.find(mesh, frame, required.horizon_m(), MAX_PAIRS, pairs) == ProximityEnd::Complete
    }

    fn num_below(&mut self) -> usize {
        self.look();
        self.too_close().count()
    }

    /// Pairs that some reader finds too close.
    fn too_close(&self) -> impl Iterator<Item = &ProximityPair> {
        let Self { mesh, frame, required, .. } = self;
        self.pairs.iter().filter(move |pair| pair.distance_m < required.least_m(mesh, frame, pair))
    }

    fn rank(&self) -> Rank {
        let missing = |pair: &ProximityPair| self.required.least_m(self.mesh, &self.frame, pair) - pair.distance_m;
        self.too_close().fold((0, 0.0), |(count, sum), pair| (count + 1, sum + missing(pair)))
    }

    /// The constraints of all pairs within the horizon that can be set apart; none where no pair that can is too close.
    /// Nothing where the work is to stop: of a gap as large as the mesh, obstacles take far longer than a step.
    fn rows(&mut self, iteration: usize) -> Option<Constraints> {
        let mut constraints = Constraints::default();
        let mut is_any_too_close = false;
        for pair in std::mem::take(&mut self.pairs) {
            if (self.should_stop)() {
                return None;
            }
            let least_m = self.required.least_m(self.mesh, &self.frame, &pair);
            if self.obstacle(&pair, least_m, iteration).is_some() {
                continue;
            }
            is_any_too_close |= pair.distance_m < least_m;
            let wanted_m = self.required.wanted_m(self.mesh, &self.frame, &pair);
            add_row(&mut constraints, self.mesh, &self.frame, pair.primitives, wanted_m);
        }
        if !is_any_too_close {
            constraints.clear();
        }
        Some(constraints)
    }

    /// What keeps a pair from being set apart, as far as is known after some iterations.
    fn obstacle(&mut self, pair: &ProximityPair, least_m: f64, iteration: usize) -> Option<ClearanceObstacle> {
        let Self { mesh, frame, input, gap_m, obstacles, known, tangled, .. } = self;
        let mut find = || {
            if pair.primitives.vertices(mesh).any(|vertex| tangled.contains(vertex)) {
                return Some(ClearanceObstacle::Tangled);
            }
            obstacles.find(mesh, [input, frame], pair.primitives, least_m)
        };
        let known = known.entry(pair.primitives).or_insert_with(|| Known {
            obstacle: find(),
            best_m: pair.distance_m,
            since: iteration,
        });
        if pair.distance_m > known.best_m + MIN_GAIN * *gap_m || pair.distance_m >= least_m {
            (known.best_m, known.since) = (pair.distance_m, iteration);
        } else if known.obstacle.is_none() && iteration >= known.since + PATIENCE {
            let is_beside = |vertex| {
                let mut next = mesh.vertex_edges(vertex).iter().map(|&edge| mesh.opposite_vertex(edge, vertex));
                next.any(|next| tangled.contains(next))
            };
            let is_beside_tangle = pair.primitives.vertices(mesh).any(is_beside);
            known.obstacle =
                Some(if is_beside_tangle { ClearanceObstacle::Tangled } else { held(mesh, pair.primitives) });
        }
        known.obstacle
    }

    /// One step; nothing where there is none.
    fn advance(&mut self, constraints: &Constraints) -> Option<Vec<Point3<f64>>> {
        let Self { mesh, frame, rest, displacement, step, settings, should_stop, gap_m, .. } = self;
        let mut domain = Domain::default();
        let near: Vec<VertexId> = constraints.violated_vertices().collect();
        domain.grow(mesh, near.into_iter(), DOMAIN_RINGS);
        let energy = ArapEnergy { mesh, frame, rest, domain: &domain, rest_weight: 0.0, membrane: 0.0, anchor: 0.0 };
        if !displacement.solve(&energy, STIFFNESS, MAX_STRETCH, constraints, Start::Cold, *should_stop) {
            return None;
        }
        step.make(&energy, &displacement.displacement, LEAST_MOTION * *gap_m, settings.single_precision, *should_stop)
    }

    /// The result, from the state in the frame.
    fn finish(mut self, given: &[[f64; 3]], interrupted: bool) -> Clearance {
        let iteration = self.history.len();
        let pairs: Vec<ProximityPair> = self.too_close().copied().collect();
        let left = |pair: ProximityPair| -> Left {
            let least_m = self.required.least_m(self.mesh, &self.frame, &pair);
            // Work that was ended looks for no further obstacles.
            let obstacle = if interrupted {
                self.known.get(&pair.primitives).and_then(|known| known.obstacle)
            } else {
                self.obstacle(&pair, least_m, iteration)
            };
            let obstacle = obstacle.unwrap_or(ClearanceObstacle::Ended);
            (pair.primitives.vertices(self.mesh).map(|vertex| vertex.0).collect(), pair.distance_m, obstacle)
        };
        let left: Vec<Left> = pairs.iter().copied().map(left).collect();
        let is_below = |pair: &&ProximityPair| pair.primitives.are_nearer(self.mesh, &self.frame, self.gap_m);
        let num_pairs_below = pairs.iter().filter(is_below).count();
        let states = self.frame.positions().iter().zip(self.input.positions()).zip(given);
        // A frame takes the smallest values as zero.
        let restored = |((after, before), given): ((&Point3<f64>, &Point3<f64>), &[f64; 3])| {
            if after == before { *given } else { (*after).into() }
        };
        Clearance {
            positions: states.map(restored).collect(),
            history: self.history,
            num_pairs_below,
            infeasible: places(left),
            interrupted,
        }
    }
}
