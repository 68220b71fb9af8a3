//! One step of the coupled response: the best of several trial displacements, island by island.

use nalgebra::Point3;

use super::line_search::Scene;
use crate::{
    analysis::Analysis,
    correspond::Correspondences,
    frame::Frame,
    geometry::mean_edge_length,
    mesh::VertexId,
    relax::{
        constraints::{ConstraintSource, Objective, StrainLimits, collect},
        energy::{ArapEnergy, Domain, RestShape},
        step::{
            Islands, Seams, Tangle, Trial, TrialContext, TrialSettings, choose_together, least_tangled, mark_passing,
            measure,
        },
    },
    sides::Orientation,
    sparse_map::SparseMap,
};

/// Width of the k-ring round the constraints that may move.
const RINGS: usize = 10;
/// Width of the k-ring that belongs to an island.
pub(super) const REACH: usize = 2 * RINGS;
/// The part of the rest shape in the edges that are kept, from the second step on.
const REST_WEIGHT: f64 = 0.3;
/// A step is made only where it leaves at most this part of the tangle: cloth that was moved far for little springs
/// back, and takes more along than was won.
const MAX_LEFT: f64 = 0.9;
/// The trials in order. Each has an objective, a stiffness, whose root is the length, in edges, over which a
/// displacement decays, and the factor by which edges may change their length before they are made stiffer. Those after
/// the first are made only where it does not help everywhere.
const TRIALS: [TrialSettings; 5] = [
    TrialSettings { objective: Objective::Normal, stiffness: 16.0, max_stretch: 1.2 },
    TrialSettings { objective: Objective::Target, stiffness: 16.0, max_stretch: 1.2 },
    TrialSettings { objective: Objective::Normal, stiffness: 256.0, max_stretch: f64::INFINITY },
    TrialSettings { objective: Objective::Normal, stiffness: 1.0, max_stretch: 1.2 },
    TrialSettings { objective: Objective::Shorten, stiffness: 16.0, max_stretch: 1.2 },
];

/// Where a step begins.
#[derive(Clone, Copy)]
pub(super) struct Begin<'a> {
    pub(super) frame: &'a Frame,
    pub(super) analysis: &'a Analysis,
    pub(super) islands: &'a Islands,
    pub(super) found: &'a Correspondences,
    /// The shape of the frame that the host sent, and how far it may be strained.
    pub(super) rest: &'a RestShape,
    pub(super) limits: &'a StrainLimits,
    pub(super) is_first: bool,
}

/// Makes steps, reusing its memory.
#[derive(Debug, Default)]
pub(super) struct Trials {
    /// Where the step leads.
    pub(super) positions: Vec<Point3<f64>>,
    orientation: Option<Orientation>,
    domain: Domain,
    trials: Vec<Trial>,
    /// Vertices where the sheets are to pass through each other.
    passing: SparseMap<VertexId, ()>,
    now: Vec<Tangle>,
}

impl Trials {
    /// Finds where a step leads. False where nothing makes any island better, or time is up before a trial is judged.
    ///
    /// Each trial is the least change of the present shape, as rigid as possible, that takes every point inside to the
    /// other side of the sheet it penetrated, or to its target, and makes paths without an inside shorter. Sheets that
    /// meet on the way become constraints. Paths that are marked as cut off by a deadline have none. Each island takes
    /// the best trial.
    ///
    /// Cost: of a trial some factorisations of a sparse system over the vertices near the paths, and up to six searches
    /// for intersections; it allocates.
    pub(super) fn run(&mut self, scene: &Scene<'_>, begin: &Begin<'_>, should_stop: &dyn Fn() -> bool) -> bool {
        let Scene { mesh, precision, limits: search_limits, .. } = *scene;
        let Begin { frame, analysis, islands, found, rest, limits, is_first } = *begin;
        let segments = &analysis.paths.segments;
        let Some(edge_length_m) = mean_edge_length(mesh, frame, segments.iter().map(|segment| segment.own)) else {
            return false;
        };
        let orientation = &*self.orientation.get_or_insert_with(|| Orientation::of(mesh));
        let source = ConstraintSource { mesh, frame, analysis, found, orientation };
        self.trials.resize_with(TRIALS.len(), Trial::default);
        for (trial, settings) in self.trials.iter_mut().zip(&TRIALS) {
            trial.is_usable = false;
            collect(&mut trial.constraints, &source, settings.objective);
        }
        if self.trials[0].constraints.len() == 0 {
            return false;
        }
        self.domain.grow(mesh, self.trials[0].constraints.vertices(), RINGS);
        mark_passing(mesh, analysis, &mut self.passing);
        measure(mesh, frame, &analysis.intersections, None, islands, &mut self.now);
        let Self { domain, trials, now, .. } = self;
        let rest_weight = if is_first { 0.0 } else { REST_WEIGHT };
        let context = TrialContext {
            energy: ArapEnergy { mesh, frame, rest, domain, rest_weight, membrane: 0.0, anchor: 0.0 },
            present: &analysis.intersections,
            sides: None,
            islands,
            limits,
            passing: &self.passing,
            now,
            edge_length_m,
            precision,
            search_limits,
        };
        for (index, settings) in TRIALS.into_iter().enumerate() {
            trials[index].run(&context, settings, should_stop);
            let helps = |island: usize| best(&trials[..=index], now, &[island]).is_some();
            if (0..now.len()).all(|island| now[island].is_none() || helps(island)) || should_stop() {
                break;
            }
        }
        let seams = Seams { mesh, domain, islands, limits, before: frame.positions() };
        let (choice, positions) = choose_together(&seams, trials, |group| best(trials, now, group));
        self.positions = positions;
        choice.iter().any(Option::is_some)
    }
}

/// The trial that leaves a group of islands least tangled, if it takes away enough of the tangle.
fn best(trials: &[Trial], now: &[Tangle], group: &[usize]) -> Option<usize> {
    let merit = |tangles: &[Tangle]| group.iter().map(|&island| tangles[island].merit()).sum::<f64>();
    let index = least_tangled(trials, now, group, false)?;
    (merit(&trials[index].best.tangles) <= MAX_LEFT * merit(now)).then_some(index)
}
