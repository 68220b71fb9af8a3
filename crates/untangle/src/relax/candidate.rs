//! One motion that is tried: found, placed, judged, with its memory.

use nalgebra::Point3;

use super::{
    clusters::{Clusters, Tangle, measure},
    damping::Damping,
    goals::{Aim, Goals, Scene},
    guard::Guard,
    motion::MotionSolver,
    shape::Body,
};
use crate::{
    correspond::MaterialPoint,
    frame::Frame,
    intersect::{Intersections, Intersector},
    mesh::VertexId,
};

/// Longest motion of one iteration, in mean edge lengths of the faces that intersect.
const LONGEST: f64 = 6.0;
/// How often a motion is found again, with what it ran into as obstacles.
const CONTACT_ROUNDS: usize = 2;
/// Gap that is kept from an obstacle, as a part of the edge that ran into it.
const CONTACT_GAP: f64 = 0.3;
/// Strains beyond this logarithm count against a state that still intersects: what is crushed now gets in the way of the next motion.
const LARGE_STRAIN: f64 = 0.25;
/// How often a motion that helps nothing is halved.
const HALVINGS: usize = 3;
/// Motions are damped round what they would crush: half as much in each of so many rounds, then not at all in so many more.
const DAMPING_ROUNDS: [usize; 2] = [3, 7];

/// A way to make a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Try {
    pub(super) aim: Aim,
    /// Its root is the length, in edges, over which a motion dies away.
    pub(super) stiffness: f64,
    /// Edges that change their length by more than this factor get stiffer.
    pub(super) tolerated: f64,
}

/// What all candidates of one iteration share.
#[derive(Clone, Copy)]
pub(super) struct Trial<'a> {
    pub(super) scene: Scene<'a>,
    pub(super) body: Body<'a>,
    pub(super) clusters: &'a Clusters,
    pub(super) guard: &'a Guard,
    /// For each vertex whether the sheets are to pass through each other here.
    pub(super) spared: &'a [bool],
    /// What each cluster is now.
    pub(super) now: &'a [Tangle],
    /// Mean edge length of the faces that intersect, in metres.
    pub(super) edge_length_m: f64,
    pub(super) single_precision: bool,
}

impl Trial<'_> {
    fn cluster(&self, vertex: VertexId) -> usize {
        self.clusters.of(vertex).unwrap_or(self.clusters.len())
    }
}

/// A state that is judged cluster by cluster.
#[derive(Debug, Default)]
pub(super) struct State {
    pub(super) positions: Vec<Point3<f64>>,
    /// For each cluster, and last for what lies near none.
    pub(super) tangles: Vec<Tangle>,
    /// For each cluster the largest logarithm of an edge's length over that in the input.
    pub(super) strains: Vec<f64>,
}

/// One motion that is tried.
#[derive(Debug, Default)]
pub(super) struct Candidate {
    pub(super) goals: Goals,
    /// The best of the steps along the motion, cluster by cluster.
    pub(super) best: State,
    /// Whether there is anything in `best`.
    pub(super) usable: bool,
    solver: MotionSolver,
    step: State,
    frame: Frame,
    intersector: Intersector,
    found: Intersections,
    damping: Damping,
    refused: Vec<usize>,
}

impl Candidate {
    /// Finds the motion that reaches the goals, with obstacles where it runs into something, and the best step along it.
    pub(super) fn attempt(&mut self, trial: &Trial<'_>, attempt: Try) {
        self.usable = false;
        for round in 0..=CONTACT_ROUNDS {
            if !self.solver.solve(&trial.body, attempt.stiffness, attempt.tolerated, &self.goals, round > 0) {
                return;
            }
            self.limit(trial);
            if !self.judge(trial) {
                return;
            }
            if round == CONTACT_ROUNDS || !self.add_contacts(trial) {
                break;
            }
        }
        self.usable = true;
        self.best.positions.clone_from(&self.step.positions);
        self.best.tangles.clone_from(&self.step.tangles);
        self.best.strains.clone_from(&self.step.strains);
        for _ in 0..HALVINGS {
            let helps = |(best, now): (&Tangle, &Tangle)| best.is_none() || best.merit() < now.merit();
            if self.best.tangles.iter().zip(trial.now).all(helps) {
                break;
            }
            for motion in &mut self.solver.motion {
                *motion *= 0.5;
            }
            if !self.judge(trial) {
                break;
            }
            self.keep_better(trial);
        }
    }

    /// Shrinks the motion of clusters that go too far.
    fn limit(&mut self, trial: &Trial<'_>) {
        let longest = LONGEST * trial.edge_length_m;
        let mut largest = vec![0.0f64; trial.clusters.len() + 1];
        for (&vertex, motion) in trial.body.domain.vertices().iter().zip(&self.solver.motion) {
            let largest = &mut largest[trial.cluster(vertex)];
            *largest = largest.max(motion.norm());
        }
        for (&vertex, motion) in trial.body.domain.vertices().iter().zip(&mut self.solver.motion) {
            let largest = largest[trial.cluster(vertex)];
            if largest > longest {
                *motion *= longest / largest;
            }
        }
    }

    /// Makes the step and measures where it leads; false where the numbers don't allow it.
    fn judge(&mut self, trial: &Trial<'_>) -> bool {
        let Trial { scene: Scene { mesh, .. }, body, clusters, guard, .. } = *trial;
        self.place(trial);
        if self.frame.set(mesh, self.step.positions.iter().map(|point| (*point).into())).is_err() {
            return false;
        }
        self.intersector.intersect(mesh, &self.frame, &mut self.found);
        measure(mesh, &self.frame, &self.found, clusters, &mut self.step.tangles);
        self.step.strains.clear();
        self.step.strains.resize(clusters.len() + 1, 0.0);
        for &vertex in body.domain.vertices() {
            let strain = &mut self.step.strains[trial.cluster(vertex)];
            for &edge in mesh.vertex_edges(vertex) {
                *strain = strain.max(guard.stretch(mesh, &self.step.positions, edge).ln().abs());
            }
        }
        true
    }

    /// Moves, damping the motion round what would be crushed or overstretched.
    fn place(&mut self, trial: &Trial<'_>) {
        let vertices = trial.body.domain.vertices();
        let before = trial.body.frame.positions();
        self.step.positions.clear();
        self.step.positions.extend_from_slice(before);
        self.damping.reset(vertices.len());
        let [halving, stopping] = DAMPING_ROUNDS;
        for round in 0..=halving + stopping + 1 {
            for (slot, &vertex) in vertices.iter().enumerate() {
                let point = before[vertex.index()] + self.solver.motion[slot] * self.damping.factor(slot);
                self.step.positions[vertex.index()] = if trial.single_precision { rounded(point) } else { point };
            }
            self.refused.clear();
            let refused = |vertex| trial.guard.refuses(trial.scene.mesh, before, &self.step.positions, vertex);
            self.refused.extend((0..vertices.len()).filter(|&slot| refused(vertices[slot])));
            if self.refused.is_empty() {
                break;
            }
            if round < halving + stopping {
                let factor = if round < halving { 0.5 } else { 0.0 };
                self.damping.damp(trial.scene.mesh, trial.body.domain, self.refused.iter().copied(), factor);
            } else {
                // The last resort: nothing moves in these clusters.
                let mut stays = vec![false; trial.clusters.len() + 1];
                for &slot in &self.refused {
                    stays[trial.cluster(vertices[slot])] = true;
                }
                self.damping.stop(|slot| stays[trial.cluster(vertices[slot])]);
            }
        }
    }

    /// Adds goals for what the step ran into; false if there is nothing new.
    fn add_contacts(&mut self, trial: &Trial<'_>) -> bool {
        let before = self.goals.len();
        let Scene { mesh, frame, analysis, .. } = trial.scene;
        for found in &self.found.edge_face {
            let known = analysis
                .intersections
                .edge_face
                .binary_search_by(|other| (other.edge, other.face).cmp(&(found.edge, found.face)))
                .is_ok();
            let (ends, corners) = (mesh.edge(found.edge), mesh.face(found.face));
            let is_spared = |vertices: &[VertexId]| vertices.iter().any(|vertex| trial.spared[vertex.index()]);
            if known || (is_spared(&ends) && is_spared(&corners)) {
                continue;
            }
            let own = MaterialPoint {
                vertices: [ends[0], ends[1], ends[1]],
                weights: [1.0 - found.edge_parameter, found.edge_parameter, 0.0],
            };
            let partner = MaterialPoint { vertices: corners, weights: found.barycentric };
            let edge_m = (frame.position(ends[1]) - frame.position(ends[0])).norm();
            self.goals.keep_apart(frame, &own, &partner, CONTACT_GAP * edge_m);
        }
        self.goals.len() > before
    }

    /// Takes over the clusters that the last step leaves less tangled.
    fn keep_better(&mut self, trial: &Trial<'_>) {
        let better = |cluster: usize| self.step.tangles[cluster].merit() < self.best.tangles[cluster].merit();
        for &vertex in trial.body.domain.vertices() {
            if better(trial.cluster(vertex)) {
                self.best.positions[vertex.index()] = self.step.positions[vertex.index()];
            }
        }
        for cluster in 0..self.step.tangles.len() {
            if self.step.tangles[cluster].merit() < self.best.tangles[cluster].merit() {
                self.best.tangles[cluster] = self.step.tangles[cluster];
                self.best.strains[cluster] = self.step.strains[cluster];
            }
        }
    }
}

/// The candidate that leaves a cluster least tangled, and of those that leave it clean the one with the least strain. Nothing if
/// none is better than staying, unless something must change.
pub(super) fn choose(candidates: &[Candidate], now: &[Tangle], cluster: usize, must_change: bool) -> Option<usize> {
    let must_change = must_change && !now[cluster].is_none();
    let mut best = (if must_change { f64::INFINITY } else { now[cluster].merit() }, f64::INFINITY, None);
    for (index, candidate) in candidates.iter().enumerate().filter(|(_, candidate)| candidate.usable) {
        let strain = candidate.best.strains[cluster];
        let merit = candidate.best.tangles[cluster].merit() * (1.0 + (strain - LARGE_STRAIN).max(0.0));
        let calmer = best.2.is_some() && candidate.best.tangles[cluster].is_none() && strain < best.1;
        if merit < best.0 || (merit <= best.0 && calmer) {
            best = (merit, strain, Some(index));
        }
    }
    best.2
}

/// The sum over all clusters.
pub(super) fn total(tangles: &[Tangle]) -> Tangle {
    let mut sum = Tangle::default();
    for tangle in tangles {
        sum.num_edge_face += tangle.num_edge_face;
        sum.length_edges += tangle.length_edges;
        sum.length_m += tangle.length_m;
    }
    sum
}

pub(super) fn rounded(point: Point3<f64>) -> Point3<f64> {
    #[expect(clippy::cast_possible_truncation, reason = "rounding is the purpose")]
    let single = point.map(|value| f64::from(value as f32));
    single
}
