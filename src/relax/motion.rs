//! The motion of one iteration: the least change of shape that reaches the goals.
//!
//! Minimises the energy of [`shape`](super::shape) plus `W/2 sum max(0, wanted - B d)^2` by semismooth Newton steps: goals that are not yet
//! reached act, the others don't. Each step is one symmetric positive definite system, solved by conjugate gradients with the
//! factorised shape as preconditioner.

use nalgebra::{Matrix3, Vector3};

use super::{
    goals::Goals,
    shape::{Body, Stiffness},
};

/// Weight of the goals against the motion of one vertex.
#[allow(non_snake_case)]
fn HARDNESS() -> f64 {
    super::knob("HARD", 1000.0)
}
const PASSES: usize = 4;
const ROUNDS: usize = 4;
const MOST_STEPS: usize = 60;
const ACCURACY: f64 = 1e-3;

/// Memory of the solver.
#[derive(Debug, Default)]
pub(super) struct MotionSolver {
    pub(super) motion: Vec<Vector3<f64>>,
    rotations: Vec<[Matrix3<f64>; 2]>,
    force: Vec<Vector3<f64>>,
    residual: Vec<Vector3<f64>>,
    precond: Vec<Vector3<f64>>,
    search: Vec<Vector3<f64>>,
    image: Vec<Vector3<f64>>,
    rows: Vec<f64>,
    active: Vec<bool>,
    emphasis: Vec<f64>,
    scratch: Vec<f64>,
}

impl MotionSolver {
    /// Finds the motion; it stands in `motion` then, one vector for each vertex of the domain.
    pub(super) fn solve(&mut self, body: &Body<'_>, stiffness: f64, tolerated: f64, goals: &Goals) -> bool {
        let size = body.domain.vertices().len();
        for vectors in [
            &mut self.motion,
            &mut self.force,
            &mut self.residual,
            &mut self.precond,
            &mut self.search,
            &mut self.image,
        ] {
            vectors.clear();
            vectors.resize(size, Vector3::zeros());
        }
        self.emphasis.clear();
        self.emphasis.resize(body.mesh.num_edges(), 1.0);
        for round in 0..ROUNDS {
            let Some(factors) = Stiffness::factorise(body, stiffness, &self.emphasis) else { return false };
            for _ in 0..PASSES {
                factors.force(body, &self.motion, &self.emphasis, &mut self.rotations, &mut self.force);
                goals.apply(body.domain, &self.motion, &mut self.rows);
                self.active.clear();
                self.active.extend(self.rows.iter().enumerate().map(|(goal, &reached)| reached < goals.wanted_m(goal)));
                self.descend(body, &factors, goals);
            }
            if round + 1 == ROUNDS || !self.emphasise(body, tolerated) {
                break;
            }
        }
        true
    }

    /// Makes edges stiffer that change their length too much; false if there are none.
    fn emphasise(&mut self, body: &Body<'_>, tolerated: f64) -> bool {
        let mut any = false;
        let limit = tolerated.ln();
        for &vertex in body.domain.vertices() {
            for &edge in body.mesh.vertex_edges(vertex) {
                let [a, b] = body.mesh.edge(edge);
                // Each edge once.
                if vertex == a || body.domain.local(if vertex == a { b } else { a }).is_none() {
                    let strain = body.stretch(&self.motion, edge).ln().abs() / limit;
                    if strain > 1.0 {
                        any = true;
                        self.emphasis[edge.index()] =
                            (self.emphasis[edge.index()] * strain * strain * super::knob("EMPH", 2.0)).min(1000.0);
                    }
                }
            }
        }
        any
    }

    /// Conjugate gradients on `(A + W B^T B) d = force + W B^T wanted`, from the present motion, over the acting goals.
    fn descend(&mut self, body: &Body<'_>, stiffness: &Stiffness, goals: &Goals) {
        self.image_of_motion(body, stiffness, goals);
        for (local, residual) in self.residual.iter_mut().enumerate() {
            *residual = self.force[local] - self.image[local];
        }
        for goal in (0..goals.len()).filter(|&goal| self.active[goal]) {
            for (vertex, coefficient) in goals.row(goal) {
                if let Some(local) = body.domain.local(*vertex) {
                    self.residual[local] += coefficient * (HARDNESS() * goals.wanted_m(goal));
                }
            }
        }
        self.precond.copy_from_slice(&self.residual);
        stiffness.solve(&mut self.precond, &mut self.scratch);
        self.search.copy_from_slice(&self.precond);
        let mut product = dot(&self.residual, &self.precond);
        let target = product * ACCURACY * ACCURACY;
        for _ in 0..MOST_STEPS {
            if product <= target || product <= 0.0 {
                break;
            }
            stiffness.multiply(body, &self.search, &self.emphasis, &mut self.image);
            self.add_goals(body, goals, true);
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

    fn image_of_motion(&mut self, body: &Body<'_>, stiffness: &Stiffness, goals: &Goals) {
        stiffness.multiply(body, &self.motion, &self.emphasis, &mut self.image);
        self.add_goals(body, goals, false);
    }

    /// Adds `W B^T B v` of the acting goals to the image, for the search direction or the motion.
    fn add_goals(&mut self, body: &Body<'_>, goals: &Goals, of_search: bool) {
        let vectors = if of_search { &self.search } else { &self.motion };
        for goal in (0..goals.len()).filter(|&goal| self.active[goal]) {
            let here = |(vertex, coefficient): &(_, Vector3<f64>)| {
                body.domain.local(*vertex).map(|local| (local, *coefficient))
            };
            let reached: f64 = goals
                .row(goal)
                .iter()
                .filter_map(here)
                .map(|(local, coefficient)| coefficient.dot(&vectors[local]))
                .sum();
            for (local, coefficient) in goals.row(goal).iter().filter_map(here) {
                self.image[local] += coefficient * (HARDNESS() * reached);
            }
        }
    }
}

fn dot(a: &[Vector3<f64>], b: &[Vector3<f64>]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
}
