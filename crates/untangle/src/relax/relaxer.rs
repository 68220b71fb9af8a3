//! The state of a relaxation under way, and what all its phases do with it.

use std::ops::ControlFlow;

use nalgebra::Point3;
use rayon::prelude::*;

use super::{
    constraints::StrainLimits,
    energy::{ArapEnergy, Domain, RestShape},
    outcome::{End, Iteration, Method, RelaxError, Solution},
    plan::Largest,
    settings::{RelaxSettings, ShouldStop, StopObserver},
    sides::SideTracker,
    step::{
        Islands, Precision, Seams, Tangle, Trial, TrialContext, TrialSettings, choose_together, is_movable, measure,
        num_movable, remove_pinned_chains,
    },
};
use crate::{
    analysis::Analyser,
    correspond::Correspondent,
    frame::Frame,
    intersect::{Intersections, SearchLimits},
    mesh::{Mesh, VertexId},
    settings::{InsideChoice, Settings},
    sides::Orientation,
    sparse_map::SparseMap,
};

/// The caller's function that is told of each iteration, and may end the work.
pub(super) type Progress<'p> = dyn FnMut(&Iteration) -> ControlFlow<()> + 'p;

/// One relaxation under way.
pub(super) struct Relaxer<'a> {
    pub(super) mesh: &'a Mesh,
    pub(super) settings: &'a RelaxSettings,
    pub(super) should_stop: &'a ShouldStop<'a>,
    pub(super) analysis_settings: Settings,
    pub(super) frame: Frame,
    pub(super) rest: RestShape,
    pub(super) limits: StrainLimits,
    pub(super) orientation: Orientation,
    pub(super) analyser: Analyser,
    pub(super) correspondent: Correspondent,
    /// What is judged and chosen together in an iteration.
    pub(super) islands: Islands,
    /// How tangled each island is now.
    pub(super) now: Vec<Tangle>,
    pub(super) domain: Domain,
    /// Memory of trials; those of an iteration are the first of them.
    pub(super) trials: Vec<Trial>,
    /// Vertices where the sheets are to pass through each other.
    pub(super) passing: SparseMap<VertexId, ()>,
    /// The islands of the input, which say what belongs together once nothing intersects any more.
    pub(super) first_islands: Islands,
    /// The bodies and layers, if there are any.
    pub(super) sides: Option<SideTracker>,
    pub(super) edge_length_m: f64,
    pub(super) history: Vec<Iteration>,
}

impl<'a> Relaxer<'a> {
    pub(super) fn new(
        mesh: &'a Mesh,
        positions: &[[f64; 3]],
        settings: &'a RelaxSettings,
        should_stop: &'a ShouldStop<'a>,
    ) -> Result<Self, RelaxError> {
        let frame = Frame::new(mesh, positions)?;
        Ok(Self {
            mesh,
            settings,
            should_stop,
            analysis_settings: Settings { inside: InsideChoice::Work, ..Settings::default() },
            rest: RestShape::of(mesh, &frame),
            sides: SideTracker::of(mesh, &frame),
            limits: StrainLimits::of(mesh, &frame),
            orientation: Orientation::of(mesh),
            frame,
            analyser: Analyser::default(),
            correspondent: Correspondent::default(),
            islands: Islands::default(),
            now: Vec::new(),
            domain: Domain::default(),
            trials: Vec::new(),
            passing: SparseMap::default(),
            first_islands: Islands::default(),
            edge_length_m: 0.0,
            history: Vec::new(),
        })
    }

    /// The present state, and how the last plan ended.
    pub(super) fn into_solution(self, end: End, largest: Largest, interrupted: bool) -> Solution {
        let positions = self.frame.positions().to_vec();
        Solution { positions, history: self.history, end, is_crowded: largest.is_crowded(), interrupted }
    }

    pub(super) fn is_exhausted(&self) -> bool {
        self.history.len() >= self.settings.max_iterations
    }

    pub(super) fn set_frame(&mut self, positions: &[Point3<f64>]) -> Result<(), RelaxError> {
        self.frame.set(self.mesh, positions.iter().map(|point| (*point).into()))?;
        self.analyse();
        Ok(())
    }

    /// The free vertices on the wrong side: inside of a body, or behind a layer.
    pub(super) fn wrong_vertices(&self) -> Vec<VertexId> {
        let positions = self.frame.positions();
        self.sides.as_ref().map(|sides| sides.wrong_vertices(self.mesh, positions)).unwrap_or_default()
    }

    /// Analyses the present state, without the chains among pinned vertices.
    pub(super) fn analyse(&mut self) {
        let Self { mesh, frame, analysis_settings, .. } = self;
        let select = |found: &mut Intersections| {
            remove_pinned_chains(mesh, found);
        };
        self.analyser.analyse_part(mesh, frame, analysis_settings, select, &mut StopObserver(self.should_stop));
    }

    /// Finds the islands of the present state, each with the `reach`-ring round it, and how tangled they are.
    pub(super) fn measure_islands(&mut self, reach: usize) {
        let analysis = self.analyser.last();
        let positions = self.frame.positions();
        let wrong = self.sides.as_ref().map(|sides| sides.wrong_groups(self.mesh, positions)).unwrap_or_default();
        self.islands.find(self.mesh, analysis, &wrong, reach);
        let found = &analysis.intersections;
        measure(self.mesh, &self.frame, found, self.sides.as_ref(), &self.islands, &mut self.now);
    }

    /// Makes room for trials.
    pub(super) fn resize_trials(&mut self, num_trials: usize) {
        self.trials.resize_with(num_trials.max(self.trials.len()), Trial::default);
    }

    /// Runs a trial for each of the settings, in parallel, with the constraints that it has, over the present domain.
    pub(super) fn run_trials(&mut self, settings: &[TrialSettings], rest_weight: f64) {
        let energy = ArapEnergy {
            mesh: self.mesh,
            frame: &self.frame,
            rest: &self.rest,
            domain: &self.domain,
            rest_weight,
            membrane: 0.0,
            anchor: 0.0,
        };
        let context = TrialContext {
            energy,
            present: &self.analyser.last().intersections,
            sides: self.sides.as_ref(),
            islands: &self.islands,
            limits: &self.limits,
            passing: &self.passing,
            now: &self.now,
            edge_length_m: self.edge_length_m,
            precision: if self.settings.single_precision { Precision::Single } else { Precision::Double },
            search_limits: SearchLimits::NONE,
        };
        let should_stop = self.should_stop;
        let trials = self.trials.par_iter_mut().zip(settings);
        trials.for_each(|(trial, settings)| trial.run(&context, *settings, should_stop));
    }

    /// Whether nothing intersects that a motion can change, and no free vertex is on the wrong side.
    pub(super) fn is_clean(&self) -> bool {
        num_movable(self.mesh, &self.analyser.last().intersections) == 0 && self.wrong_vertices().is_empty()
    }

    /// Whether nothing intersects that a motion can change, and what is left is cloth on the wrong side of bodies or
    /// layers.
    pub(super) fn is_on_wrong_side_only(&self) -> bool {
        num_movable(self.mesh, &self.analyser.last().intersections) == 0 && !self.wrong_vertices().is_empty()
    }

    /// Whether nothing is left but what hangs on vertices that are pinned inside of a body, which no motion resolves.
    pub(super) fn hangs_on_pins(&self) -> bool {
        let Self { mesh, frame, .. } = self;
        let found = self.analyser.last().intersections.edge_face.iter().filter(|found| is_movable(mesh, found));
        let vertices = found.map(|found| mesh.edge(found.edge).into_iter().chain(mesh.face(found.face)).collect());
        self.sides.as_ref().is_some_and(|sides| sides.hangs_on_pins(mesh, frame.positions(), vertices))
    }

    /// Chooses a trial for each group of islands, and joins groups that would tear the cloth between them. Gives back
    /// the choice for each island, and where it leads.
    pub(super) fn choose(&self, choose: impl Fn(&[usize]) -> Option<usize>) -> (Vec<Option<usize>>, Vec<Point3<f64>>) {
        let Self { mesh, domain, islands, limits, frame, .. } = self;
        let seams = Seams { mesh, domain, islands, limits, before: frame.positions() };
        choose_together(&seams, &self.trials, choose)
    }

    /// The farthest that a vertex is from its place in the input, in metres.
    pub(super) fn largest_displacement_m(&self) -> f64 {
        let pairs = self.frame.positions().iter().zip(self.rest.positions());
        pairs.map(|(now, input)| (now - input).norm()).fold(0.0, f64::max)
    }

    /// Notes the analysed state after an iteration.
    pub(super) fn report(&mut self, method: Method, progress: &mut Progress<'_>) -> ControlFlow<()> {
        let analysis = self.analyser.last();
        let num_edge_face = num_movable(self.mesh, &analysis.intersections);
        let length_m = analysis.paths.pairs.iter().map(|pair| pair.length_m).sum();
        self.note(method, num_edge_face, length_m, progress)
    }

    /// Notes a state after an iteration.
    pub(super) fn note(
        &mut self,
        method: Method,
        num_edge_face_intersections: usize,
        path_length_m: f64,
        progress: &mut Progress<'_>,
    ) -> ControlFlow<()> {
        let iteration = Iteration { num_edge_face_intersections, path_length_m, method, num_pairs_below: None };
        self.history.push(iteration);
        progress(&iteration)
    }
}
