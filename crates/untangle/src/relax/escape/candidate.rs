//! One displacement field: found, made within the strain limits, and judged island by island.

use nalgebra::Point3;

use super::{
    limited_step::LimitedStep,
    motion::{Motion, Shadow, remaining_depth_m},
    rows::Rows,
    score::{Score, add_moved},
};
use crate::{
    frame::Frame,
    intersect::{Intersections, Intersector},
    relax::{
        constraints::{Constraints, StrainLimits},
        energy::ArapEnergy,
        settings::ShouldStop,
        sides::SideTracker,
        step::{DisplacementSolver, Islands, SolverBudget, Start, Tangle, island_strains, measure},
    },
};

/// The work for one displacement: steps are small, and another iteration follows.
const NEWTON_STEPS: usize = 4;
const CG_STEPS: usize = 40;
/// Weight of the constraints beside the stiffness.
const PENALTY: f64 = 62.5;
/// How often a step is halved.
const MAX_HALVINGS: usize = 2;

/// How a candidate is found.
#[derive(Clone, Copy, Debug)]
pub(super) struct Recipe {
    pub(super) rows: Rows,
    /// Its root is the length, in edges, over which a displacement decays.
    pub(super) stiffness: f64,
    /// Edges that change their length by more than this factor get stiffer.
    pub(super) max_stretch: f64,
}

/// What all candidates of one iteration share.
#[derive(Clone, Copy)]
pub(super) struct Context<'a> {
    pub(super) energy: ArapEnergy<'a>,
    pub(super) sides: Option<&'a SideTracker>,
    pub(super) islands: &'a Islands,
    pub(super) limits: &'a StrainLimits,
    /// The motions of the present state, each with its island.
    pub(super) motions: &'a [(Motion, usize)],
    pub(super) now: &'a [Score],
    pub(super) edge_length_m: f64,
    pub(super) single_precision: bool,
    pub(super) should_stop: &'a ShouldStop<'a>,
}

/// A state that is judged.
#[derive(Debug, Default)]
pub(super) struct Judged {
    pub(super) positions: Vec<Point3<f64>>,
    /// One for each island, and one for what lies near none.
    pub(super) scores: Vec<Score>,
}

/// One displacement field, with its memory.
#[derive(Debug, Default)]
pub(super) struct Candidate {
    pub(super) best: Judged,
    pub(super) is_usable: bool,
    solver: DisplacementSolver,
    step: Judged,
    frame: Frame,
    intersector: Intersector,
    found: Intersections,
    limited: LimitedStep,
    tangles: Vec<Tangle>,
    strains: Vec<f64>,
    shadow: Shadow,
}

impl Candidate {
    /// Finds the displacement for a recipe, and the best step along it for each island.
    pub(super) fn run(&mut self, context: &Context<'_>, constraints: &Constraints, recipe: Recipe) {
        let Recipe { stiffness, max_stretch, .. } = recipe;
        self.solver.budget =
            SolverBudget { newton_steps: NEWTON_STEPS, cg_steps: CG_STEPS, penalty: PENALTY * stiffness.max(16.0) };
        self.is_usable =
            self.solver.solve(&context.energy, stiffness, max_stretch, constraints, Start::Cold, context.should_stop)
                && self.judge(context);
        if !self.is_usable {
            return;
        }
        self.best.positions.clone_from(&self.step.positions);
        self.best.scores.clone_from(&self.step.scores);
        for _ in 0..MAX_HALVINGS {
            if self.best.scores.iter().zip(context.now).all(|(best, now)| best.value() <= now.value()) {
                break;
            }
            self.solver.displacement.iter_mut().for_each(|displacement| *displacement *= 0.5);
            if !self.judge(context) {
                break;
            }
            self.keep_better(context);
        }
    }

    /// Makes the step and judges where it leads; false where the numbers don't allow it.
    fn judge(&mut self, context: &Context<'_>) -> bool {
        let ArapEnergy { mesh, domain, .. } = context.energy;
        let (displacement, out) = (&self.solver.displacement, &mut self.step.positions);
        self.limited.make(context.energy, context.islands, displacement, context.single_precision, out);
        if self.frame.set(mesh, self.step.positions.iter().map(|point| (*point).into())).is_err() {
            return false;
        }
        self.intersector.intersect(mesh, &self.frame, &mut self.found);
        measure(mesh, &self.frame, &self.found, context.sides, context.islands, &mut self.tangles);
        let (islands, limits) = (context.islands, context.limits);
        island_strains(mesh, domain, islands, limits, &self.step.positions, &mut self.strains);
        self.step.scores.clear();
        let scores = self.tangles.iter().zip(&self.strains);
        self.step.scores.extend(scores.map(|(&tangle, &strain)| Score { tangle, strain, ..Score::default() }));
        add_moved(context.energy, islands, &self.step.positions, context.edge_length_m, &mut self.step.scores);
        self.shadow.set_hinged(mesh, &self.found);
        for (motion, island) in context.motions {
            let depth_m = remaining_depth_m(&mut self.shadow, mesh, &self.frame, motion);
            self.step.scores[*island].depth += motion.weight() * depth_m / motion.edge_length_m;
        }
        true
    }

    /// Takes over the islands that the last step leaves better.
    fn keep_better(&mut self, context: &Context<'_>) {
        let Self { step, best, .. } = self;
        let better: Vec<bool> =
            step.scores.iter().zip(&best.scores).map(|(step, best)| step.value() < best.value()).collect();
        for &vertex in context.energy.domain.vertices() {
            if better[context.islands.of(vertex)] {
                best.positions[vertex.index()] = step.positions[vertex.index()];
            }
        }
        for (island, _) in better.iter().enumerate().filter(|(_, better)| **better) {
            best.scores[island] = step.scores[island];
        }
    }
}
