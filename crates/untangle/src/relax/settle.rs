//! Back towards the shape of the input, once nothing intersects any more.

use rayon::prelude::*;

use super::{
    RelaxError,
    candidate::{Candidate, Trial, Try},
    clusters::Tangle,
    goals::{Aim, Scene},
    plan::TOLERATED,
    shape::Body,
    solver::Relaxer,
};

/// Gap that is kept while the shape comes back, in mean edge lengths.
const SETTLED_GAP: f64 = 0.2;
/// Strains below this logarithm are left alone.
const SMALL_STRAIN: f64 = 0.05;

impl Relaxer<'_> {
    /// Brings back some of the input's shape, with what was parted held apart. False if that was not possible, or not needed.
    pub(super) fn settle(&mut self) -> Result<bool, RelaxError> {
        let Self { mesh, frame, domain, candidates, .. } = self;
        let mesh = *mesh;
        let clusters = &self.first_clusters;
        let moved = mesh.vertex_ids().filter(|&vertex| self.shape.position(vertex) != frame.position(vertex));
        domain.grow(mesh, moved, 2);
        let mut strains = vec![0.0f64; clusters.len() + 1];
        for &vertex in domain.vertices() {
            let strain = &mut strains[clusters.of(vertex).unwrap_or(clusters.len())];
            for &edge in mesh.vertex_edges(vertex) {
                *strain = strain.max(self.guard.stretch(mesh, frame.positions(), edge).ln().abs());
            }
        }
        if strains.iter().all(|&strain| strain < SMALL_STRAIN) {
            return Ok(false);
        }
        let analysis = self.analyser.last();
        let found = self.correspondent.find(mesh, frame, analysis, &self.analysis_settings, &mut ());
        self.spared.clear();
        self.spared.resize(mesh.num_vertices(), false);
        self.now.clear();
        self.now.resize(clusters.len() + 1, Tangle::default());
        let trial = Trial {
            scene: Scene { mesh, frame, analysis, found, orientation: &self.orientation },
            body: Body { mesh, frame, shape: &self.shape, domain, memory: 1.0 },
            clusters,
            guard: &self.guard,
            spared: &self.spared,
            now: &self.now,
            edge_length_m: self.edge_length_m,
            single_precision: self.settings.single_precision,
        };
        let tries = [16.0, 256.0].map(|stiffness| Try { aim: Aim::Normal, stiffness, tolerated: TOLERATED });
        candidates.resize_with(tries.len().max(candidates.len()), Candidate::default);
        let candidates = &mut candidates[..tries.len()];
        let parted = &self.parted;
        candidates.par_iter_mut().zip(&tries).for_each(|(candidate, attempt)| {
            candidate.goals.clear();
            candidate.goals.hold(parted, frame);
            candidate.goals.stay_apart(frame, SETTLED_GAP * trial.edge_length_m);
            candidate.attempt(&trial, *attempt);
        });
        let mut positions = frame.positions().to_vec();
        let choice: Vec<Option<usize>> = (0..=clusters.len())
            .map(|cluster| {
                let mut best = (0.98 * strains[cluster], None);
                for (index, candidate) in candidates.iter().enumerate().filter(|(_, candidate)| candidate.usable) {
                    let state = &candidate.best;
                    if state.tangles[cluster].is_none() && state.strains[cluster] < best.0 {
                        best = (state.strains[cluster], Some(index));
                    }
                }
                best.1
            })
            .collect();
        for &vertex in domain.vertices() {
            if let Some(index) = choice[clusters.of(vertex).unwrap_or(clusters.len())] {
                positions[vertex.index()] = candidates[index].best.positions[vertex.index()];
            }
        }
        let before = frame.positions().to_vec();
        self.set_frame(&positions)?;
        if self.analyser.last().intersections.edge_face.is_empty() {
            return Ok(choice.iter().any(Option::is_some));
        }
        // Clusters that moved differently met at their borders.
        self.set_frame(&before)?;
        Ok(false)
    }
}
