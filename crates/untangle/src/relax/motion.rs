//! The motion of one iteration: the least change of shape that reaches the goals.
//!
//! Minimises the energy of [`shape`](super::shape) plus `W/2 sum max(0, wanted - B d)^2` by semismooth Newton steps: goals that are not yet
//! reached act, the others don't. Each step is one symmetric positive definite system, solved by conjugate gradients with the
//! factorised shape as preconditioner.

use nalgebra::{Matrix3, Vector3};

use super::{
    goals::Goals,
    local::{LocalGoals, reached},
    shape::{Body, Stiffness},
};

/// Weight of the goals against the motion of one vertex.
const HARDNESS: f64 = 1000.0;
/// Newton steps, each with the rotations that fit the motion so far.
const PASSES: usize = 12;
/// Passes end when the motion changes by no more than this part of its size.
const SETTLED: f64 = 0.01;
/// How often edges that stretch too much are made stiffer.
const ROUNDS: usize = 4;
/// Each time by this factor, and the square of the excess.
const EMPHASIS: f64 = 2.0;
const LARGEST_EMPHASIS: f64 = 1000.0;
const MOST_STEPS: usize = 60;
/// Conjugate gradients end at this part of the first residual of a round.
const ACCURACY: f64 = 1e-3;

/// Memory of the solver.
#[derive(Debug, Default)]
pub(super) struct MotionSolver {
    /// One vector for each vertex of the domain, in metres.
    pub(super) motion: Vec<Vector3<f64>>,
    goals: LocalGoals,
    rotations: Vec<[Matrix3<f64>; 2]>,
    force: Vec<Vector3<f64>>,
    residual: Vec<Vector3<f64>>,
    precond: Vec<Vector3<f64>>,
    search: Vec<Vector3<f64>>,
    image: Vec<Vector3<f64>>,
    before: Vec<Vector3<f64>>,
    active: Vec<bool>,
    emphasis: Vec<f64>,
    scratch: Vec<f64>,
}

impl MotionSolver {
    /// Finds the motion. Edges that change their length by more than a factor `tolerated` are made stiffer, again and again. With `again` it goes
    /// on from the last motion, of the same domain, and its stiffer edges. False where a system can't be factorised.
    ///
    /// Cost: some factorisations of the domain's graph Laplacian and some hundred solutions with them.
    pub(super) fn solve(
        &mut self,
        body: &Body<'_>,
        stiffness: f64,
        tolerated: f64,
        goals: &Goals,
        again: bool,
    ) -> bool {
        let size = body.domain.vertices().len();
        self.goals.set(goals, body.domain);
        if !again {
            self.motion.clear();
            self.emphasis.clear();
        }
        self.emphasis.resize(body.mesh.num_edges(), 1.0);
        for vectors in [
            &mut self.motion,
            &mut self.force,
            &mut self.residual,
            &mut self.precond,
            &mut self.search,
            &mut self.image,
            &mut self.before,
        ] {
            vectors.resize(size, Vector3::zeros());
        }
        for round in 0..if again { 1 } else { ROUNDS } {
            let Some(factors) = Stiffness::factorise(body, stiffness, &self.emphasis) else { return false };
            // Passes begin where the last one ended: what is left to them gets ever less, and is not worth more digits.
            let mut target = None;
            for _ in 0..PASSES {
                self.before.copy_from_slice(&self.motion);
                factors.force(body, &self.motion, &self.emphasis, &mut self.rotations, &mut self.force);
                let motion = &self.motion;
                self.active.clear();
                self.active.extend(self.goals.rows().map(|(row, wanted_m)| reached(row, motion) < wanted_m));
                self.descend(&factors, &mut target);
                if self.is_settled() {
                    break;
                }
            }
            if round + 1 == ROUNDS || !self.emphasise(body, tolerated) {
                break;
            }
        }
        true
    }

    /// Whether the last pass changed little.
    fn is_settled(&self) -> bool {
        let change: f64 = self.motion.iter().zip(&self.before).map(|(now, before)| (now - before).norm_squared()).sum();
        let size: f64 = self.motion.iter().map(Vector3::norm_squared).sum();
        change <= SETTLED * SETTLED * size
    }

    /// Makes edges stiffer that change their length too much; false if there are none.
    fn emphasise(&mut self, body: &Body<'_>, tolerated: f64) -> bool {
        let mut any = false;
        let limit = tolerated.ln();
        for &vertex in body.domain.vertices() {
            for &edge in body.mesh.vertex_edges(vertex) {
                let [first, second] = body.mesh.edge(edge);
                // Each edge once.
                if vertex == first || body.domain.local(first).is_none() {
                    debug_assert!(vertex == first || vertex == second);
                    let strain = body.stretch(&self.motion, edge).ln().abs() / limit;
                    if strain > 1.0 {
                        any = true;
                        let emphasis = &mut self.emphasis[edge.index()];
                        *emphasis = (*emphasis * strain * strain * EMPHASIS).min(LARGEST_EMPHASIS);
                    }
                }
            }
        }
        any
    }

    /// Conjugate gradients on `(A + W B^T B) d = force + W B^T wanted`, from the present motion, over the acting goals.
    fn descend(&mut self, stiffness: &Stiffness, target: &mut Option<f64>) {
        stiffness.multiply(&self.motion, &mut self.image);
        for (residual, (force, image)) in self.residual.iter_mut().zip(self.force.iter().zip(&self.image)) {
            *residual = force - image;
        }
        for ((row, wanted_m), _) in self.goals.rows().zip(&self.active).filter(|(_, active)| **active) {
            let missing = wanted_m - reached(row, &self.motion);
            for (local, coefficient) in row {
                self.residual[*local] += coefficient * (HARDNESS * missing);
            }
        }
        self.precond.copy_from_slice(&self.residual);
        stiffness.solve(&mut self.precond, &mut self.scratch);
        self.search.copy_from_slice(&self.precond);
        let mut product = dot(&self.residual, &self.precond);
        let target = *target.get_or_insert(product * ACCURACY * ACCURACY);
        for _ in 0..MOST_STEPS {
            if product <= target || product <= 0.0 {
                break;
            }
            stiffness.multiply(&self.search, &mut self.image);
            for ((row, _), _) in self.goals.rows().zip(&self.active).filter(|(_, active)| **active) {
                let along = reached(row, &self.search);
                for (local, coefficient) in row {
                    self.image[*local] += coefficient * (HARDNESS * along);
                }
            }
            let curvature = dot(&self.search, &self.image);
            if curvature <= 0.0 {
                break;
            }
            let step = product / curvature;
            for local in 0..self.motion.len() {
                self.motion[local] += self.search[local] * step;
                self.residual[local] -= self.image[local] * step;
            }
            self.precond.copy_from_slice(&self.residual);
            stiffness.solve(&mut self.precond, &mut self.scratch);
            let next = dot(&self.residual, &self.precond);
            let keep = next / product;
            for (search, precond) in self.search.iter_mut().zip(&self.precond) {
                *search = precond + *search * keep;
            }
            product = next;
        }
    }
}

fn dot(a: &[Vector3<f64>], b: &[Vector3<f64>]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
}
