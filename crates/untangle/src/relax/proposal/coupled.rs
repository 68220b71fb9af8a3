//! The coupled response of one frame: a displacement that resolves all paths together, in some steps.

use std::ops::ControlFlow;

use nalgebra::{Point3, Vector3};

use super::{
    line_search::Scene,
    trials::{Begin, REACH, Trials},
};
use crate::{
    analysis::{Analyser, Analysis},
    correspond::{Correspondences, Correspondent},
    frame::Frame,
    intersect::SearchEnd,
    mesh::VertexId,
    relax::{
        constraints::StrainLimits,
        energy::{Domain, RestShape},
        outcome::Iteration,
        settings::{Effort, RelaxSettings, StopObserver},
        solver::solve,
        step::{Islands, Precision, Tangle, measure_touched, sent},
    },
    settings::Settings,
};

/// Most steps of one frame. Each begins where the one before it ended.
const MAX_STEPS: usize = 8;
/// Steps that leave more than this part of the tangle are no help: the frame is relaxed by all means. With a half, two
/// scenes of the example host took seconds a frame that are clean in as many frames without.
const MOST_LEFT: f64 = 0.9;
/// Most iterations of that.
const MAX_ITERATIONS: usize = 24;

/// Finds coupled displacements of one mesh, reusing its memory from frame to frame.
#[derive(Debug, Default)]
pub(super) struct Coupled {
    /// The vertices that move.
    pub(super) domain: Domain,
    /// One for each vertex of the domain, as it will be sent.
    pub(super) displacement: Vec<Vector3<f64>>,
    trials: Trials,
    state: State,
    positions: Vec<Point3<f64>>,
    relaxed: Vec<Point3<f64>>,
}

/// A state on the way, analysed.
#[derive(Debug, Default)]
struct State {
    frame: Frame,
    analyser: Analyser,
    correspondent: Correspondent,
    islands: Islands,
    tangles: Vec<Tangle>,
    all: Tangle,
}

impl Coupled {
    /// Looks for the displacement of a frame, for [`finish`](Self::finish) to take. Pinned vertices don't move, nor do
    /// islands that nothing makes better. Gives back the merit of where it leads; nothing where time was up before a
    /// step was judged.
    ///
    /// The displacement is made in steps, as `fix` makes them, until nothing intersects, a step hardly helps, or time
    /// is up. Momentum is not kept.
    ///
    /// Cost: an analysis for each step but the first, and its [trials](Trials::run); it allocates.
    pub(super) fn find(
        &mut self,
        scene: &Scene<'_>,
        analysis: &Analysis,
        found: &Correspondences,
        settings: &Settings,
        should_stop: &dyn Fn() -> bool,
    ) -> Option<f64> {
        let Scene { mesh, frame, .. } = *scene;
        let (rest, limits) = (RestShape::of(mesh, frame), StrainLimits::of(mesh, frame));
        self.positions.clear();
        self.positions.extend_from_slice(frame.positions());
        let mut merit = scene.now.all.merit();
        for step in 0..MAX_STEPS {
            let Self { trials, state, .. } = self;
            let is_first = step == 0;
            if !is_first {
                state.correspond(scene, settings, should_stop);
            }
            let begin = Begin {
                frame: if is_first { frame } else { &state.frame },
                analysis: if is_first { analysis } else { state.analyser.last() },
                islands: if is_first { scene.islands } else { &state.islands },
                found: if is_first { found } else { state.correspondent.found() },
                rest: &rest,
                limits: &limits,
                is_first,
            };
            if !trials.run(scene, &begin, should_stop) {
                if is_first && should_stop() {
                    return None;
                }
                break;
            }
            let Some(after) = state.reach(scene, &trials.positions, settings, should_stop) else { break };
            if after >= merit {
                break;
            }
            self.positions.clone_from(&trials.positions);
            merit = after;
            if after <= 0.0 || should_stop() {
                break;
            }
        }
        Some(merit)
    }

    /// Takes the displacement that was found. Where the least merit of all that was tried is hardly less than that of
    /// the frame, the frame is relaxed by all means first. False where what was found leads to more than that merit.
    pub(super) fn finish(
        &mut self,
        scene: &Scene<'_>,
        [found, least]: [f64; 2],
        settings: &Settings,
        should_stop: &dyn Fn() -> bool,
    ) -> bool {
        let is_no_help = least > MOST_LEFT * scene.now.all.merit() && !should_stop();
        let is_relaxed = is_no_help && self.relax(scene, least, settings, should_stop);
        self.take(scene);
        is_relaxed || found <= least
    }

    /// Relaxes the frame as `fix` does, in few iterations, and takes the state that this ends in if it is less tangled
    /// than a merit; whether it is.
    fn relax(&mut self, scene: &Scene<'_>, merit: f64, settings: &Settings, should_stop: &dyn Fn() -> bool) -> bool {
        let Scene { mesh, frame, precision, .. } = *scene;
        let single_precision = precision == Precision::Sent { is_single: true };
        let relax_settings = RelaxSettings {
            effort: Effort::Fast,
            max_iterations: MAX_ITERATIONS,
            single_precision,
            other_attempts: false,
        };
        let positions: Vec<[f64; 3]> = frame.positions().iter().map(|point| (*point).into()).collect();
        let mut progress =
            |_: &Iteration| if should_stop() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
        let Ok(solution) = solve(mesh, &positions, &relax_settings, &mut progress, &|| false) else {
            return false;
        };
        self.relaxed = solution.positions;
        let after = self.state.reach(scene, &self.relaxed, settings, should_stop);
        let is_better = after.is_some_and(|after| after < merit);
        if is_better {
            self.positions.clone_from(&self.relaxed);
        }
        is_better
    }

    /// Takes what moved.
    fn take(&mut self, scene: &Scene<'_>) {
        let Scene { mesh, frame, .. } = *scene;
        let positions = &self.positions;
        // A vertex without mass is sent none.
        let has_mass = |vertex: VertexId| mesh.masses_kg().is_none_or(|masses| masses[vertex.index()] > 0.0);
        let moved = |vertex: &VertexId| positions[vertex.index()] != frame.position(*vertex) && has_mass(*vertex);
        self.domain.grow(mesh, mesh.vertex_ids().filter(moved), 0);
        let displaced = |vertex: &VertexId| sent(positions[vertex.index()] - frame.position(*vertex));
        self.displacement.clear();
        self.displacement.extend(self.domain.vertices().iter().map(displaced));
    }
}

impl State {
    /// Goes to other positions and analyses them; gives back the merit of what is there. Nothing where the numbers, the
    /// limits or the time don't allow it.
    fn reach(
        &mut self,
        scene: &Scene<'_>,
        positions: &[Point3<f64>],
        settings: &Settings,
        should_stop: &dyn Fn() -> bool,
    ) -> Option<f64> {
        let Scene { mesh, .. } = *scene;
        let Self { frame, analyser, islands, tangles, all, .. } = self;
        frame.set(mesh, positions.iter().map(|point| (*point).into())).ok()?;
        analyser.analyse(mesh, frame, settings, &mut StopObserver(should_stop));
        if analyser.search_end() != SearchEnd::Complete {
            return None;
        }
        let analysis = analyser.last();
        islands.find(mesh, analysis, &[], REACH);
        measure_touched(mesh, frame, &analysis.intersections, islands, tangles, all);
        Some(all.merit())
    }

    fn correspond(&mut self, scene: &Scene<'_>, settings: &Settings, should_stop: &dyn Fn() -> bool) {
        let Self { frame, analyser, correspondent, .. } = self;
        correspondent.find(scene.mesh, frame, analyser.last(), settings, &mut StopObserver(should_stop));
    }
}
