//! The iterations: analyse, try several motions, keep for each cluster of paths the one that helps most.

use std::ops::ControlFlow;

use nalgebra::Point3;
use rayon::prelude::*;

use super::{
    BlockedPath, Iteration, Method, Quality, RelaxError, RelaxSettings, Relaxation,
    clusters::{Clusters, Tangle, measure},
    domain::Domain,
    goals::{Aim, Goals, Scene},
    guard::Guard,
    motion::MotionSolver,
    orient::Orientation,
    shape::{Body, Shape},
};
use crate::{
    analysis::Analyser,
    correspond::Correspondent,
    frame::Frame,
    intersect::{Intersections, Intersector},
    mesh::Mesh,
    settings::Settings,
};

const RINGS: usize = 14;

/// Longest motion of one iteration, in mean edge lengths of the cloth round the paths.
const LONGEST: f64 = 6.0;
const PATIENCE: usize = 8;

/// A way to make a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Try {
    aim: Aim,
    stiffness: f64,
    /// Edges that change their length by more than this factor get stiffer.
    tolerated: f64,
}

/// One motion that is tried, with its memory.
#[derive(Default)]
struct Candidate {
    goals: Goals,
    solver: MotionSolver,
    intersector: Intersector,
    found: Intersections,
    frame: Frame,
    positions: Vec<Point3<f64>>,
    tangles: Vec<Tangle>,
    /// For each cluster the largest logarithm of an edge's length over that in the input.
    strains: Vec<f64>,
    usable: bool,
}

pub(super) fn run(
    mesh: &Mesh,
    positions: &[[f64; 3]],
    settings: &RelaxSettings,
    progress: &mut dyn FnMut(&Iteration) -> ControlFlow<()>,
) -> Result<Relaxation, RelaxError> {
    let mut frame = Frame::new(mesh, positions)?;
    let verbose = std::env::var("RELAX_VERBOSE").is_ok();
    let mut analyser = Analyser::default();
    let analysis_settings = Settings::default();
    let mut correspondent = Correspondent::default();
    let orientation = Orientation::of(mesh);
    let shape = Shape::of(mesh, &frame);
    let guard = Guard::of(mesh, &frame);
    let mut clusters = Clusters::default();
    let mut domain = Domain::default();
    let mut candidates: Vec<Candidate> = Vec::new();
    let mut history = Vec::new();
    let mut best: (f64, Vec<Point3<f64>>) = (f64::INFINITY, frame.positions().to_vec());
    let mut impatience = 0;
    let mut interrupted = false;
    let mut blocked = Vec::new();
    loop {
        let analysis = analyser.analyse(mesh, &frame, &analysis_settings, &mut ());
        clusters.find(mesh, analysis, RINGS);
        let mut now = Vec::new();
        measure(mesh, &frame, &analysis.intersections, &clusters, &mut now);
        let merit: f64 = now.iter().map(Tangle::merit).sum();
        if merit < best.0 {
            best = (merit, frame.positions().to_vec());
            impatience = 0;
        } else {
            impatience += 1;
        }
        if merit <= 0.0 && analysis.intersections.edge_face.is_empty() {
            break;
        }
        if history.len() >= settings.max_iterations || impatience > PATIENCE {
            blocked = analysis
                .paths
                .pairs
                .iter()
                .map(|pair| BlockedPath {
                    pair_type: pair.pair_type,
                    vertex: mesh
                        .face(analysis.paths.segments[analysis.paths.copies[pair.copies.start].segments.start].own)[0]
                        .0,
                    length_m: pair.length_m,
                    reason: "none of the methods shortened it".into(),
                })
                .collect();
            break;
        }
        let found = correspondent.find(mesh, &frame, analysis, &analysis_settings);
        let scene = Scene { mesh, frame: &frame, analysis, found, orientation: &orientation };
        let tries: Vec<Try> = tries(settings.quality, impatience);
        candidates.resize_with(tries.len().max(candidates.len()), Candidate::default);
        for (candidate, attempt) in candidates.iter_mut().zip(&tries) {
            candidate.goals.collect(&scene, |_| attempt.aim);
        }
        let seeds = || candidates[..tries.len()].iter().flat_map(|candidate| candidate.goals.vertices());
        domain.grow(mesh, seeds(), RINGS);
        let body = Body {
            mesh,
            frame: &frame,
            shape: &shape,
            domain: &domain,
            memory: if history.is_empty() { 0.0 } else { super::knob("MEM", 0.5) },
        };
        let mut edge = 0.0;
        let mut count = 0.0f64;
        for segment in &analysis.paths.segments {
            let [a, b, c] = mesh.face(segment.own).map(|vertex| frame.position(vertex));
            edge += (b - a).norm() + (c - b).norm() + (a - c).norm();
            count += 3.0;
        }
        let longest = LONGEST * edge / count.max(1.0);
        candidates.par_iter_mut().zip(&tries).for_each(|(candidate, attempt)| {
            candidate.usable = false;
            if !candidate.solver.solve(&body, attempt.stiffness, attempt.tolerated, &candidate.goals) {
                return;
            }
            candidate.limit(&body, &clusters, longest);
            candidate.place(&body, &clusters, &guard, settings.single_precision);
            candidate.detect(mesh, &clusters);
            candidate.measure_strain(&body, &clusters, &guard);
        });
        // For each cluster the best candidate.
        let mut choice: Vec<Option<usize>> = vec![None; clusters.len() + 1];
        for cluster in 0..=clusters.len() {
            let mut best_merit = if impatience == 0 { now[cluster].merit() } else { f64::INFINITY };
            let mut best_strain = f64::INFINITY;
            for (index, candidate) in
                candidates[..tries.len()].iter().enumerate().filter(|(_, candidate)| candidate.usable)
            {
                let merit = candidate.tangles[cluster].merit();
                let strain = candidate.strains[cluster];
                if merit < best_merit
                    || (merit <= best_merit && merit <= 0.0 && strain < best_strain && choice[cluster].is_some())
                {
                    best_merit = merit;
                    best_strain = strain;
                    choice[cluster] = Some(index);
                }
            }
        }
        let mut composed = frame.positions().to_vec();
        for &vertex in domain.vertices() {
            let cluster = clusters.of(vertex).unwrap_or(clusters.len());
            if let Some(index) = choice[cluster] {
                composed[vertex.index()] = candidates[index].positions[vertex.index()];
            }
        }
        if verbose {
            let merits: Vec<String> = candidates[..tries.len()]
                .iter()
                .zip(&tries)
                .map(|(c, t)| {
                    format!(
                        "{:?}/{}: {} {:.1}",
                        t.aim,
                        t.stiffness,
                        c.found.edge_face.len(),
                        c.tangles.iter().map(Tangle::merit).sum::<f64>()
                    )
                })
                .collect();
            eprintln!(
                "iteration {} ef {} merit {merit:.2} impatience {impatience} clusters {} goals {} domain {} {merits:?} {:?}",
                history.len(),
                analysis.intersections.edge_face.len(),
                clusters.len(),
                candidates[0].goals.len(),
                domain.vertices().len(),
                choice
            );
        }
        frame.set(mesh, composed.iter().map(|p| [p.x, p.y, p.z]))?;
        let mut tally = [0usize; 3];
        for index in choice.iter().flatten() {
            tally[tries[*index].aim as usize] += 1;
        }
        let method = match tally.iter().enumerate().max_by_key(|(_, n)| **n).map(|(k, _)| k) {
            Some(0) => Method::Push,
            Some(1) => Method::Rbf,
            _ => Method::Contour,
        };
        let iteration = Iteration {
            num_edge_face_intersections: analysis.intersections.edge_face.len(),
            path_length_m: now.iter().map(|tangle| tangle.length_m).sum(),
            method,
        };
        history.push(iteration);
        if progress(&iteration).is_break() {
            interrupted = true;
            break;
        }
    }
    let positions = if blocked.is_empty() { frame.positions() } else { &best.1[..] };
    Ok(Relaxation {
        positions: if history.is_empty() {
            positions_of_input(positions, frame.positions())
        } else {
            positions.iter().map(|p| [p.x, p.y, p.z]).collect()
        },
        history,
        blocked,
        interrupted,
    })
}

fn positions_of_input(_: &[Point3<f64>], input: &[Point3<f64>]) -> Vec<[f64; 3]> {
    input.iter().map(|p| [p.x, p.y, p.z]).collect()
}

fn tries(quality: Quality, impatience: usize) -> Vec<Try> {
    let stiffnesses: &[f64] = match quality {
        Quality::Fast => &[16.0],
        _ => &[1.0, 16.0, 256.0],
    };
    let mut tries = Vec::new();
    let aims: &[Aim] = if impatience == 0 { &[Aim::Normal] } else { &[Aim::Normal, Aim::Target, Aim::Shorten] };
    for &aim in aims {
        for &stiffness in stiffnesses {
            for tolerated in [f64::INFINITY, super::knob("TOL", 1.08)] {
                tries.push(Try { aim, stiffness, tolerated });
            }
        }
    }
    tries
}

impl Candidate {
    /// Shrinks the motion of a cluster that goes too far.
    fn limit(&mut self, body: &Body<'_>, clusters: &Clusters, longest: f64) {
        let mut largest = vec![0.0f64; clusters.len() + 1];
        for (&vertex, motion) in body.domain.vertices().iter().zip(&self.solver.motion) {
            let cluster = clusters.of(vertex).unwrap_or(clusters.len());
            largest[cluster] = largest[cluster].max(motion.norm());
        }
        for (&vertex, motion) in body.domain.vertices().iter().zip(&mut self.solver.motion) {
            let cluster = clusters.of(vertex).unwrap_or(clusters.len());
            if largest[cluster] > longest {
                *motion *= longest / largest[cluster];
            }
        }
    }

    /// Moves, halving the motion of clusters until nothing is crushed or overstretched.
    fn place(&mut self, body: &Body<'_>, clusters: &Clusters, guard: &Guard, single: bool) {
        let before = body.frame.positions();
        self.positions.clear();
        self.positions.extend_from_slice(before);
        let mut scale = vec![1.0f64; clusters.len() + 1];
        for round in 0..5 {
            for (&vertex, motion) in body.domain.vertices().iter().zip(&self.solver.motion) {
                let cluster = clusters.of(vertex).unwrap_or(clusters.len());
                let mut point = before[vertex.index()] + motion * scale[cluster];
                if single {
                    #[expect(clippy::cast_possible_truncation, reason = "rounding is the purpose")]
                    let rounded = point.map(|value| f64::from(value as f32));
                    point = rounded;
                }
                self.positions[vertex.index()] = point;
            }
            let mut refused = vec![false; clusters.len() + 1];
            for &vertex in body.domain.vertices() {
                let cluster = clusters.of(vertex).unwrap_or(clusters.len());
                refused[cluster] |= body
                    .mesh
                    .vertex_faces(vertex)
                    .iter()
                    .any(|&face| guard.refuses_face(body.mesh, before, &self.positions, face))
                    || body
                        .mesh
                        .vertex_edges(vertex)
                        .iter()
                        .any(|&edge| guard.refuses_edge(body.mesh, before, &self.positions, edge));
            }
            let mut any = false;
            for (scale, refused) in scale.iter_mut().zip(refused) {
                if refused {
                    any = true;
                    *scale = if round == 3 { 0.0 } else { *scale * 0.5 };
                }
            }
            if !any {
                break;
            }
        }
    }

    fn measure_strain(&mut self, body: &Body<'_>, clusters: &Clusters, guard: &Guard) {
        self.strains.clear();
        self.strains.resize(clusters.len() + 1, 0.0);
        for &vertex in body.domain.vertices() {
            let strain = &mut self.strains[clusters.of(vertex).unwrap_or(clusters.len())];
            for &edge in body.mesh.vertex_edges(vertex) {
                *strain = strain.max(guard.stretch(body.mesh, &self.positions, edge).ln().abs());
            }
        }
    }

    fn detect(&mut self, mesh: &Mesh, clusters: &Clusters) {
        self.usable = self.frame.set(mesh, self.positions.iter().map(|p| [p.x, p.y, p.z])).is_ok();
        if self.usable {
            self.intersector.intersect(mesh, &self.frame, &mut self.found);
            measure(mesh, &self.frame, &self.found, clusters, &mut self.tangles);
        }
    }
}
