//! The iterations: analyse, try several motions, keep for each cluster of paths the one that helps most.

use std::ops::ControlFlow;

use nalgebra::Point3;
use rayon::prelude::*;

use super::{
    Iteration, Method, RelaxError, RelaxSettings, Relaxation,
    blocked::blocked_paths,
    candidate::{Candidate, Trial, Try, choose, total},
    clusters::{Clusters, Tangle, measure},
    domain::Domain,
    goals::{Aim, Goals, Scene},
    guard::Guard,
    orient::Orientation,
    plan::{Patience, Plan, is_hopeless, plans, tries},
    shape::{Body, Shape},
};
use crate::{
    analysis::{Analyser, Analysis},
    correspond::Correspondent,
    frame::Frame,
    intersect::{Intersections, Intersector},
    mesh::Mesh,
    settings::{InsideChoice, Settings},
};

/// Rings round the goals that may move.
const RINGS: usize = 14;
/// From the second iteration on, edges are drawn this far towards their shape in the input.
const MEMORY: f64 = 0.3;
/// Iterations that bring back the shape once nothing intersects any more.
const SETTLINGS: usize = 4;

/// Why iterations ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum End {
    Clean,
    Stuck,
    Exhausted,
    Interrupted,
}

/// The least tangled state so far.
pub(super) struct Best {
    pub(super) merit: f64,
    pub(super) positions: Vec<Point3<f64>>,
}

/// One relaxation under way.
pub(super) struct Relaxer<'a> {
    pub(super) mesh: &'a Mesh,
    pub(super) settings: &'a RelaxSettings,
    pub(super) analysis_settings: Settings,
    pub(super) frame: Frame,
    pub(super) shape: Shape,
    pub(super) guard: Guard,
    pub(super) orientation: Orientation,
    pub(super) analyser: Analyser,
    pub(super) correspondent: Correspondent,
    clusters: Clusters,
    pub(super) domain: Domain,
    pub(super) candidates: Vec<Candidate>,
    pub(super) spared: Vec<bool>,
    pub(super) now: Vec<Tangle>,
    /// What was parted so far, and is to stay apart.
    pub(super) parted: Goals,
    /// The clusters of the first state, which say what moves together while the shape comes back.
    pub(super) first_clusters: Clusters,
    pub(super) edge_length_m: f64,
    history: Vec<Iteration>,
}

impl<'a> Relaxer<'a> {
    pub(super) fn new(mesh: &'a Mesh, positions: &[[f64; 3]], settings: &'a RelaxSettings) -> Result<Self, RelaxError> {
        let frame = Frame::new(mesh, positions)?;
        Ok(Self {
            mesh,
            settings,
            analysis_settings: Settings { inside: InsideChoice::Work, ..Settings::default() },
            shape: Shape::of(mesh, &frame),
            guard: Guard::of(mesh, &frame),
            orientation: Orientation::of(mesh),
            frame,
            analyser: Analyser::default(),
            correspondent: Correspondent::default(),
            clusters: Clusters::default(),
            domain: Domain::default(),
            candidates: Vec::new(),
            spared: Vec::new(),
            now: Vec::new(),
            parted: Goals::default(),
            first_clusters: Clusters::default(),
            edge_length_m: 0.0,
            history: Vec::new(),
        })
    }

    pub(super) fn run(
        mut self,
        progress: &mut dyn FnMut(&Iteration) -> ControlFlow<()>,
    ) -> Result<Relaxation, RelaxError> {
        let input = self.frame.positions().to_vec();
        let mut best = Best { merit: f64::INFINITY, positions: input.clone() };
        let mut interrupted = false;
        let mut end = End::Clean;
        let largest = self.look();
        for (index, plan) in plans(largest).into_iter().enumerate() {
            if let Plan::Motions { inside, .. } = plan {
                self.analysis_settings.inside = inside;
            }
            if index > 0 {
                self.parted.clear();
                self.set_frame(&input)?;
            }
            end = match plan {
                Plan::Motions { aim, .. } => self.follow(aim, Patience::with(largest), &mut best, progress)?,
                Plan::Straighten => self.straighten(&mut best, progress)?,
            };
            interrupted = end == End::Interrupted;
            if end != End::Stuck {
                break;
            }
        }
        self.set_frame(&best.positions)?;
        let blocked = blocked_paths(self.mesh, self.analyser.last(), end);
        if blocked.is_empty() && !self.history.is_empty() {
            for _ in 0..SETTLINGS {
                if interrupted || !self.settle()? {
                    break;
                }
                interrupted = self.report(Method::Settle, progress).is_break();
            }
        }
        let positions = self.frame.positions().iter().map(|point| (*point).into()).collect();
        Ok(Relaxation { positions, history: self.history, blocked, interrupted })
    }

    /// Analyses the input. Gives back the number of edge-face intersections of the cluster of paths that has most.
    fn look(&mut self) -> usize {
        let mut found = Intersections::default();
        Intersector::default().intersect(self.mesh, &self.frame, &mut found);
        let many = is_hopeless(found.edge_face.len());
        let wanted = self.analysis_settings.inside;
        if many {
            // It tells clusters as well, and of so many paths the other choice takes minutes.
            self.analysis_settings.inside = InsideChoice::Count;
        }
        self.analyse();
        self.clusters.find(self.mesh, self.analyser.last(), 0);
        measure(self.mesh, &self.frame, &self.analyser.last().intersections, &self.clusters, &mut self.now);
        let largest = self.now.iter().map(|tangle| tangle.num_edge_face).max().unwrap_or(0);
        if many && !is_hopeless(largest) {
            self.analysis_settings.inside = wanted;
            self.analyse();
        }
        self.first_clusters.find(self.mesh, self.analyser.last(), usize::MAX / 2);
        largest
    }

    /// Iterates from the present state until nothing intersects any more, or nothing helps any more.
    fn follow(
        &mut self,
        aim: Aim,
        patience: Patience,
        best: &mut Best,
        progress: &mut dyn FnMut(&Iteration) -> ControlFlow<()>,
    ) -> Result<End, RelaxError> {
        // The least merits up to each iteration.
        let mut merits: Vec<f64> = Vec::new();
        let mut widen = false;
        for iteration in 0.. {
            let analysis = self.analyser.last();
            self.clusters.find(self.mesh, analysis, 2 * RINGS);
            measure(self.mesh, &self.frame, &analysis.intersections, &self.clusters, &mut self.now);
            let merit = total(&self.now).merit();
            if merit < best.merit {
                *best = Best { merit, positions: self.frame.positions().to_vec() };
            }
            if analysis.intersections.edge_face.is_empty() {
                return Ok(End::Clean);
            }
            let before = merits.last().copied().unwrap_or(f64::INFINITY);
            merits.push(merit.min(before));
            if self.is_exhausted() {
                return Ok(End::Exhausted);
            }
            if patience.is_over(&merits) {
                break;
            }
            let worse = merit >= before;
            let tries = tries(aim, self.settings.quality, widen || worse);
            let memory = if iteration == 0 { 0.0 } else { MEMORY };
            let (method, stuck) = self.iterate(&tries, memory, worse)?;
            widen = stuck;
            if self.report(method, progress).is_break() {
                return Ok(End::Interrupted);
            }
        }
        Ok(End::Stuck)
    }

    pub(super) fn is_exhausted(&self) -> bool {
        self.history.len() >= self.settings.max_iterations
    }

    fn analyse(&mut self) {
        self.analyser.analyse(self.mesh, &self.frame, &self.analysis_settings, &mut ());
    }

    pub(super) fn set_frame(&mut self, positions: &[Point3<f64>]) -> Result<(), RelaxError> {
        self.frame.set(self.mesh, positions.iter().map(|point| (*point).into()))?;
        self.analyse();
        Ok(())
    }

    /// Notes the state after an iteration.
    pub(super) fn report(
        &mut self,
        method: Method,
        progress: &mut dyn FnMut(&Iteration) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let analysis = self.analyser.last();
        let num_edge_face = analysis.intersections.edge_face.len();
        let length_m = analysis.paths.pairs.iter().map(|pair| pair.length_m).sum();
        self.note(method, num_edge_face, length_m, progress)
    }

    /// Notes what an iteration left.
    pub(super) fn note(
        &mut self,
        method: Method,
        num_edge_face_intersections: usize,
        path_length_m: f64,
        progress: &mut dyn FnMut(&Iteration) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let iteration = Iteration { num_edge_face_intersections, path_length_m, method };
        self.history.push(iteration);
        progress(&iteration)
    }

    /// Makes the motions of one iteration and takes the best of them, cluster by cluster. Returns the method that helped most, and
    /// whether some cluster was left as it was.
    fn iterate(&mut self, tries: &[Try], memory: f64, must_change: bool) -> Result<(Method, bool), RelaxError> {
        let Self { mesh, frame, clusters, domain, candidates, now, .. } = self;
        let analysis = self.analyser.last();
        let found = self.correspondent.find(mesh, frame, analysis, &self.analysis_settings, &mut ());
        let scene = Scene { mesh, frame, analysis, found, orientation: &self.orientation };
        candidates.resize_with(tries.len().max(candidates.len()), Candidate::default);
        let candidates = &mut candidates[..tries.len()];
        for (candidate, attempt) in candidates.iter_mut().zip(tries) {
            candidate.goals.collect(&scene, attempt.aim);
        }
        domain.grow(mesh, candidates.iter().flat_map(|candidate| candidate.goals.vertices()), RINGS);
        spare(mesh, analysis, &mut self.spared);
        self.edge_length_m = edge_length_m(mesh, frame, analysis);
        let trial = Trial {
            scene,
            body: Body { mesh, frame, shape: &self.shape, domain, memory },
            clusters,
            guard: &self.guard,
            spared: &self.spared,
            now,
            edge_length_m: self.edge_length_m,
            single_precision: self.settings.single_precision,
        };
        candidates.par_iter_mut().zip(tries).for_each(|(candidate, attempt)| candidate.attempt(&trial, *attempt));
        let choice: Vec<Option<usize>> =
            (0..=clusters.len()).map(|cluster| choose(candidates, now, cluster, must_change)).collect();
        let stuck = choice.iter().zip(now.iter()).any(|(choice, now)| choice.is_none() && !now.is_none());
        let mut positions = frame.positions().to_vec();
        for &vertex in domain.vertices() {
            if let Some(index) = choice[clusters.of(vertex).unwrap_or(clusters.len())] {
                positions[vertex.index()] = candidates[index].best.positions[vertex.index()];
            }
        }
        let mut gains = [0.0; 3];
        for (cluster, index) in choice.iter().enumerate() {
            if let Some(index) = *index {
                let aim = tries[index].aim as usize;
                gains[aim] += now[cluster].merit() - candidates[index].best.tangles[cluster].merit();
            }
        }
        self.set_frame(&positions)?;
        for index in choice.iter().flatten().copied().collect::<std::collections::BTreeSet<_>>() {
            self.parted.hold(&self.candidates[index].goals, &self.frame);
        }
        let most = (1..3).fold(0, |best, aim| if gains[aim] > gains[best] { aim } else { best });
        Ok(([Method::Push, Method::Rbf, Method::Contour][most], stuck))
    }
}

/// Marks where the sheets are to pass through each other: along the paths and inside of them.
fn spare(mesh: &Mesh, analysis: &Analysis, spared: &mut Vec<bool>) {
    spared.clear();
    spared.resize(mesh.num_vertices(), false);
    for segment in &analysis.intersections.segments {
        for vertex in segment.faces.into_iter().flat_map(|face| mesh.face(face)) {
            spared[vertex.index()] = true;
        }
    }
    for vertex in &analysis.regions.vertices {
        spared[vertex.index()] = true;
    }
}

/// Mean edge length of the faces that intersect, in metres.
fn edge_length_m(mesh: &Mesh, frame: &Frame, analysis: &Analysis) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for segment in &analysis.paths.segments {
        let [a, b, c] = mesh.face(segment.own).map(|vertex| frame.position(vertex));
        sum += (b - a).norm() + (c - b).norm() + (a - c).norm();
        count += 3.0;
    }
    if count > 0.0 { sum / count } else { 0.0 }
}
