//! The displacement of one iteration: the least change of shape that satisfies the constraints.
//!
//! Minimises the [ARAP energy](super::super::energy) plus the penalty `W/2 sum max(0, wanted - B d)^2` by semismooth
//! Newton steps with an active set: constraints that are not yet satisfied are active. Each step is one symmetric
//! positive definite system, solved by conjugate gradients with the factorised energy as preconditioner.

use nalgebra::{Matrix3, Vector3};

use crate::relax::{
    constraints::{Constraints, LocalConstraints, row_value},
    energy::{ArapEnergy, StiffnessMatrix},
};

/// Weight of the constraints against the displacement of one vertex.
const PENALTY: f64 = 1000.0;
/// Newton steps, each with the rotations that fit the displacement so far.
const MAX_NEWTON_STEPS: usize = 12;
/// Newton steps end when the displacement changes by no more than this part of its size.
const CONVERGED: f64 = 0.01;
/// How often edges that stretch too much are made stiffer.
const STIFFENING_ROUNDS: usize = 4;
/// Each time by this factor, and the square of the excess.
const STIFFENING: f64 = 2.0;
const MAX_STIFFENING: f64 = 1000.0;
const MAX_CG_STEPS: usize = 60;
/// Conjugate gradients end at this part of the first residual of a round.
const CG_TOLERANCE: f64 = 1e-3;

/// Where a solution begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Start {
    /// At no displacement, with edges as stiff as their weights.
    Cold,
    /// At the last displacement, of the same domain, with its stiffer edges.
    Warm,
}

/// How much work a solution may take, and how hard constraints are.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SolverBudget {
    /// Newton steps, each with the rotations that fit the displacement so far.
    pub(crate) newton_steps: usize,
    /// Steps of conjugate gradients in each of them.
    pub(crate) cg_steps: usize,
    /// Weight of the constraints against the displacement of one vertex.
    pub(crate) penalty: f64,
}

impl Default for SolverBudget {
    fn default() -> Self {
        Self { newton_steps: MAX_NEWTON_STEPS, cg_steps: MAX_CG_STEPS, penalty: PENALTY }
    }
}

/// Memory of the solver.
#[derive(Debug, Default)]
pub(crate) struct DisplacementSolver {
    pub(crate) budget: SolverBudget,
    /// One vector for each vertex of the domain, in metres.
    pub(crate) displacement: Vec<Vector3<f64>>,
    constraints: LocalConstraints,
    rotations: Vec<[Matrix3<f64>; 2]>,
    force: Vec<Vector3<f64>>,
    residual: Vec<Vector3<f64>>,
    precond: Vec<Vector3<f64>>,
    search: Vec<Vector3<f64>>,
    image: Vec<Vector3<f64>>,
    before: Vec<Vector3<f64>>,
    stiffening: Vec<f64>,
    scratch: Vec<Vector3<f64>>,
}

impl DisplacementSolver {
    /// Finds the displacement. Edges that change their length by more than a factor `max_stretch` are made stiffer,
    /// round by round; from a warm start there is one round. False where a system can't be factorised, or the work is
    /// to stop.
    ///
    /// Cost: some factorisations of the domain's graph Laplacian and some hundred solutions with them.
    pub(crate) fn solve(
        &mut self,
        energy: &ArapEnergy<'_>,
        stiffness: f64,
        max_stretch: f64,
        constraints: &Constraints,
        start: Start,
        should_stop: &dyn Fn() -> bool,
    ) -> bool {
        self.constraints.set(constraints, energy.domain);
        self.resize(energy, start);
        let num_rounds = if start == Start::Warm { 1 } else { STIFFENING_ROUNDS };
        for round in 0..num_rounds {
            let Some(matrix) = StiffnessMatrix::factorise(energy, stiffness, &self.stiffening) else { return false };
            if !self.minimise(energy, stiffness, &matrix, should_stop) {
                return false;
            }
            if round + 1 == STIFFENING_ROUNDS || !self.stiffen(energy, max_stretch) {
                break;
            }
        }
        true
    }

    /// Makes room for a domain.
    fn resize(&mut self, energy: &ArapEnergy<'_>, start: Start) {
        if start == Start::Cold {
            self.displacement.clear();
            self.stiffening.clear();
        }
        self.stiffening.resize(energy.mesh.num_edges(), 1.0);
        for vectors in [
            &mut self.displacement,
            &mut self.force,
            &mut self.residual,
            &mut self.precond,
            &mut self.search,
            &mut self.image,
            &mut self.before,
        ] {
            vectors.resize(energy.domain.vertices().len(), Vector3::zeros());
        }
    }

    /// Newton steps for one matrix; false where they are to stop.
    fn minimise(
        &mut self,
        energy: &ArapEnergy<'_>,
        stiffness: f64,
        matrix: &StiffnessMatrix,
        should_stop: &dyn Fn() -> bool,
    ) -> bool {
        // Each step begins where the last one ended: the remaining residuals get ever smaller, and need no more digits.
        let mut target = None;
        for _ in 0..self.budget.newton_steps {
            self.before.copy_from_slice(&self.displacement);
            energy.force(stiffness, &self.displacement, &self.stiffening, &mut self.rotations, &mut self.force);
            self.constraints.activate(&self.displacement);
            self.conjugate_gradients(matrix, &mut target, should_stop);
            if should_stop() {
                return false;
            }
            if self.is_converged() {
                break;
            }
        }
        true
    }

    /// Whether the last Newton step changed little.
    fn is_converged(&self) -> bool {
        let change: f64 =
            self.displacement.iter().zip(&self.before).map(|(now, before)| (now - before).norm_squared()).sum();
        let size: f64 = self.displacement.iter().map(Vector3::norm_squared).sum();
        change <= CONVERGED * CONVERGED * size
    }

    /// Makes edges stiffer that change their length too much; false if there are none.
    fn stiffen(&mut self, energy: &ArapEnergy<'_>, max_stretch: f64) -> bool {
        let mut any = false;
        let limit = libm::log(max_stretch);
        for &vertex in energy.domain.vertices() {
            for &edge in energy.mesh.vertex_edges(vertex) {
                let [first, second] = energy.mesh.edge(edge);
                // Each edge once.
                if vertex == first || energy.domain.local(first).is_none() {
                    debug_assert!(vertex == first || vertex == second, "edge {edge:?} has no end {vertex:?}");
                    let strain = libm::log(energy.stretch(&self.displacement, edge)).abs() / limit;
                    if strain > 1.0 {
                        any = true;
                        let stiffening = &mut self.stiffening[edge.index()];
                        *stiffening = (*stiffening * strain * strain * STIFFENING).min(MAX_STIFFENING);
                    }
                }
            }
        }
        any
    }

    /// Conjugate gradients on `(A + W B^T B) d = force + W B^T wanted`, from the present displacement, over the active
    /// constraints. `target` is where the squared residual ends; the first call sets it.
    fn conjugate_gradients(
        &mut self,
        matrix: &StiffnessMatrix,
        target: &mut Option<f64>,
        should_stop: &dyn Fn() -> bool,
    ) {
        self.begin_residual(matrix);
        self.precond.copy_from_slice(&self.residual);
        matrix.solve(&mut self.precond, &mut self.scratch);
        self.search.copy_from_slice(&self.precond);
        let mut product = dot(&self.residual, &self.precond);
        let target = *target.get_or_insert(product * CG_TOLERANCE * CG_TOLERANCE);
        for _ in 0..self.budget.cg_steps {
            if product <= target || product <= 0.0 || should_stop() {
                break;
            }
            self.multiply_search(matrix);
            let curvature = dot(&self.search, &self.image);
            if curvature <= 0.0 {
                break;
            }
            let step = product / curvature;
            for local in 0..self.displacement.len() {
                self.displacement[local] += self.search[local] * step;
                self.residual[local] -= self.image[local] * step;
            }
            self.precond.copy_from_slice(&self.residual);
            matrix.solve(&mut self.precond, &mut self.scratch);
            let next = dot(&self.residual, &self.precond);
            let keep = next / product;
            for (search, precond) in self.search.iter_mut().zip(&self.precond) {
                *search = precond + *search * keep;
            }
            product = next;
        }
    }

    /// The residual of the present displacement.
    fn begin_residual(&mut self, matrix: &StiffnessMatrix) {
        matrix.multiply(&self.displacement, &mut self.image);
        for (residual, (force, image)) in self.residual.iter_mut().zip(self.force.iter().zip(&self.image)) {
            *residual = force - image;
        }
        for (row, wanted_m) in self.constraints.active_rows() {
            let missing = wanted_m - row_value(row, &self.displacement);
            for (local, coefficient) in row {
                self.residual[*local] += coefficient * (self.budget.penalty * missing);
            }
        }
    }

    /// The matrix of the system times the search direction.
    fn multiply_search(&mut self, matrix: &StiffnessMatrix) {
        matrix.multiply(&self.search, &mut self.image);
        for (row, _) in self.constraints.active_rows() {
            let along = row_value(row, &self.search);
            for (local, coefficient) in row {
                self.image[*local] += coefficient * (self.budget.penalty * along);
            }
        }
    }
}

fn dot(a: &[Vector3<f64>], b: &[Vector3<f64>]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
}
