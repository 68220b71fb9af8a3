//! One displacement field: found, made within the strain limits, and judged island by island.

use nalgebra::Point3;

use super::{
    limits::is_violated,
    motion::{Motion, Shadow, remaining_depth_m},
    score::{Score, add_moved},
};
use crate::{
    frame::Frame,
    intersect::{Intersections, Intersector},
    relax::{
        constraints::{Constraints, StrainLimits},
        energy::ArapEnergy,
        step::{
            Backtracking, Damping, DisplacementSolver, Islands, SolverBudget, Start, Tangle, island_strains, measure,
            stored,
        },
    },
};

/// Backtracking of vertices beyond a strain limit.
const BACKTRACKING: Backtracking = Backtracking { halvings: 2, stops: 4 };
/// How often the step of an island is halved where that does not help.
const MAX_SCALINGS: usize = 4;
/// Edges that change their length by more than this factor get stiffer.
const MAX_STRETCH: f64 = 1.05;
/// The work for one displacement: steps are small, and another iteration follows.
const NEWTON_STEPS: usize = 4;
const CG_STEPS: usize = 40;
/// Weight of the constraints beside the stiffness.
const PENALTY: f64 = 62.5;
/// How often a step is halved.
const MAX_HALVINGS: usize = 2;

/// What all candidates of one iteration share.
#[derive(Clone, Copy)]
pub(super) struct Context<'a> {
    pub(super) energy: ArapEnergy<'a>,
    pub(super) islands: &'a Islands,
    pub(super) limits: &'a StrainLimits,
    /// The motions of the present state, each with its island.
    pub(super) motions: &'a [(Motion, usize)],
    pub(super) now: &'a [Score],
    pub(super) edge_length_m: f64,
    pub(super) single_precision: bool,
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
    damping: Damping,
    violated: Vec<usize>,
    tangles: Vec<Tangle>,
    strains: Vec<f64>,
    shadow: Shadow,
}

impl Candidate {
    /// Finds the displacement for a stiffness, and the best step along it for each island.
    pub(super) fn run(&mut self, context: &Context<'_>, constraints: &Constraints, stiffness: f64) {
        self.solver.budget =
            SolverBudget { newton_steps: NEWTON_STEPS, cg_steps: CG_STEPS, penalty: PENALTY * stiffness.max(16.0) };
        self.is_usable =
            self.solver.solve(&context.energy, stiffness, MAX_STRETCH, constraints, Start::Cold) && self.judge(context);
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
        self.make_step(context);
        if self.frame.set(mesh, self.step.positions.iter().map(|point| (*point).into())).is_err() {
            return false;
        }
        self.intersector.intersect(mesh, &self.frame, &mut self.found);
        measure(mesh, &self.frame, &self.found, context.islands, &mut self.tangles);
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

    /// Moves within the strain limits. Where damping does not help, the whole island moves less far.
    fn make_step(&mut self, context: &Context<'_>) {
        let islands = context.islands;
        let mut scales = vec![1.0; islands.len() + 1];
        for attempt in 1..=MAX_SCALINGS + 1 {
            if self.make_damped_step(context, &scales) {
                return;
            }
            let vertices = context.energy.domain.vertices();
            let mut is_over = vec![false; scales.len()];
            for &local in &self.violated {
                is_over[islands.of(vertices[local])] = true;
            }
            for (scale, _) in scales.iter_mut().zip(is_over).filter(|(_, is_over)| *is_over) {
                *scale = if attempt < MAX_SCALINGS { 0.5 * *scale } else { 0.0 };
            }
        }
    }

    /// Moves by a part of the displacement for each island, damped round vertices beyond their strain limits. False
    /// where some stay beyond them.
    fn make_damped_step(&mut self, context: &Context<'_>, scales: &[f64]) -> bool {
        let ArapEnergy { mesh, frame, domain, rest, .. } = context.energy;
        let vertices = domain.vertices();
        let before = frame.positions();
        self.step.positions.clear();
        self.step.positions.extend_from_slice(before);
        self.damping.reset(vertices.len());
        for round in 0..=BACKTRACKING.num_rounds() {
            for (local, &vertex) in vertices.iter().enumerate() {
                let part = self.damping.factor(local) * scales[context.islands.of(vertex)];
                let point = before[vertex.index()] + self.solver.displacement[local] * part;
                self.step.positions[vertex.index()] = stored(point, context.single_precision);
            }
            self.violated.clear();
            let is_violated = |vertex| is_violated(mesh, rest, before, &self.step.positions, vertex);
            self.violated.extend((0..vertices.len()).filter(|&local| is_violated(vertices[local])));
            if self.violated.is_empty() {
                return true;
            }
            self.damping.damp(mesh, domain, self.violated.iter().copied(), BACKTRACKING.factor(round));
        }
        false
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
