//! Which displacements are tried for a frame, and what goes out.

use std::cell::RefCell;

use nalgebra::Vector3;

use super::{
    coupled::Coupled,
    displaced::Displaced,
    judge::Merits,
    kept_apart::KeptApart,
    line_search::{LineSearch, Scene, Verdict},
    trials::REACH,
    values::step_of,
};
use crate::{
    analysis::Analysis,
    frame::Frame,
    intersect::SearchLimits,
    mesh::{Mesh, VertexId},
    relax::{
        energy::Domain,
        step::{Islands, Precision},
    },
    respond::{Corrections, Responder},
    settings::{Response, Settings},
    stage::StageObserver,
};

/// A frame that gets a displacement.
#[derive(Clone, Copy)]
pub(crate) struct AnalysedFrame<'a> {
    pub(crate) mesh: &'a Mesh,
    pub(crate) frame: &'a Frame,
    pub(crate) analysis: &'a Analysis,
    pub(crate) settings: &'a Settings,
    /// Whether the host adds displacements in single precision.
    pub(crate) is_single: bool,
    /// Whether it adds them at all, before its next step; else it takes what they say as velocities or forces.
    pub(crate) is_displaced: bool,
}

/// Judges displacements before they go out, reusing its memory from frame to frame.
///
/// What makes an island of paths worse is shortened there, and where nothing is left of it the forces of one step stand
/// in, which are judged too; where these do harm as well nothing moves. So no frame leads to a state that is more
/// tangled, in intersections and path lengths together, than its own.
#[derive(Debug, Default)]
pub(crate) struct Proposer {
    islands: Islands,
    now: Merits,
    methods: Methods,
    forces: StandIn,
    kept_apart: KeptApart,
}

impl Proposer {
    /// Replaces the values of the corrections, which are those of the response `displacement`, or none for `coupled`,
    /// by a displacement that does no harm. Where they do none and clear the frame, values of `displacement` stay to
    /// the bit.
    ///
    /// Displacements of `displacement` go on from where they lead, as long as that helps: see [`Displaced::find`].
    /// That of `coupled` is the better one of its own and of that, if its own leaves something.
    ///
    /// Where time is up before anything could be judged, the forces of one step go out in their place.
    ///
    /// Where a displacement leaves nothing that intersects, contact has to hold what was won, and where nothing moves,
    /// what there is: a host that adds displacements gets no mask and no labels there.
    ///
    /// Then what keeps the gap of the settings is added, where there is one: see [`KeptApart::add`].
    ///
    /// Cost: without a gap nothing where nothing intersects; else that of [`Displaced::find`], and of
    /// [`LineSearch::shorten`] where something is stopped; for `coupled` that of [`Coupled::find`], which alone
    /// allocates once this is warm.
    pub(crate) fn propose(
        &mut self,
        view: &AnalysedFrame<'_>,
        responder: &mut Responder,
        observer: &mut dyn StageObserver,
    ) {
        let AnalysedFrame { mesh, frame, analysis, settings, is_single, is_displaced } = *view;
        if analysis.paths.copies.is_empty() && settings.gap_m().is_none() {
            return;
        }
        self.islands.find(mesh, analysis, &[], REACH);
        self.now.measure(mesh, frame, &analysis.intersections, &self.islands);
        let Self { islands, now, methods, forces, kept_apart } = self;
        let scene = Scene {
            mesh,
            frame,
            islands,
            now,
            precision: Precision::Sent { is_single },
            limits: SearchLimits::new(settings, mesh.num_faces()),
        };
        let observer = RefCell::new(observer);
        let should_stop = || observer.borrow_mut().is_spent();
        let is_judged = !analysis.paths.copies.is_empty() && {
            let verdict = methods.find(view, &scene, responder, &should_stop);
            if verdict == Verdict::Unjudged {
                responder.respond_as(Response::Rbf, mesh, frame, analysis, settings);
                return;
            }
            let stood_in = !should_stop() && forces.stand_in(view, &scene, methods, responder, &should_stop);
            if !stood_in && verdict == Verdict::Shortened {
                let (domain, displacement) = methods.found();
                responder.displace(mesh, domain.vertices(), displacement);
            }
            true
        };
        // Before the mask is taken away: it tells what is tangled.
        kept_apart.add(&scene, settings, responder, &should_stop);
        if is_judged && is_displaced {
            forces.find_moving(islands, responder);
            let is_at_rest = |vertex| !forces.moves[islands.of(vertex)];
            responder.unmask(|vertex| methods.line_search.is_cleared(islands, vertex) || is_at_rest(vertex));
        }
    }
}

/// The ways to a displacement.
#[derive(Debug, Default)]
struct Methods {
    coupled: Coupled,
    displaced: Displaced,
    line_search: LineSearch,
    /// Whether that of the coupled response was found last.
    is_coupled: bool,
}

impl Methods {
    /// Finds a displacement by the response that was asked for. For the coupled one that to the targets is tried as
    /// well, where it leaves something, and the better of the two is found.
    ///
    /// Harmless are the values that the corrections have already.
    fn find(
        &mut self,
        view: &AnalysedFrame<'_>,
        scene: &Scene<'_>,
        responder: &mut Responder,
        should_stop: &dyn Fn() -> bool,
    ) -> Verdict {
        let AnalysedFrame { mesh, frame, analysis, settings, .. } = *view;
        let Self { coupled, displaced, line_search, is_coupled } = self;
        *is_coupled = settings.response == Response::Coupled;
        if !*is_coupled {
            return displaced.find(scene, settings, responder.corrections(), line_search, should_stop);
        }
        let Some(found) = coupled.find(scene, analysis, responder.correspondences(), settings, should_stop) else {
            return Verdict::Unjudged;
        };
        let mut least = found;
        if found > 0.0 && !should_stop() {
            responder.respond_as(Response::Displacement, mesh, frame, analysis, settings);
            let targets = Settings { response: Response::Displacement, ..settings.clone() };
            let verdict = displaced.find(scene, &targets, responder.corrections(), line_search, should_stop);
            if verdict != Verdict::Unjudged {
                least = least.min(line_search.standing.merit);
            }
        }
        *is_coupled = coupled.finish(scene, [found, least], settings, should_stop);
        let (domain, displacement) = match *is_coupled {
            true => (&coupled.domain, &mut coupled.displacement),
            false => (&displaced.domain, &mut displaced.displacement),
        };
        match line_search.shorten(scene, domain, displacement, should_stop) {
            Verdict::Unjudged => Verdict::Unjudged,
            Verdict::Harmless | Verdict::Shortened => Verdict::Shortened,
        }
    }

    /// The displacement that was found last.
    fn found(&self) -> (&Domain, &[Vector3<f64>]) {
        match self.is_coupled {
            true => (&self.coupled.domain, &self.coupled.displacement),
            false => (&self.displaced.domain, &self.displaced.displacement),
        }
    }
}

/// The forces of one step, which stand in where nothing moves.
#[derive(Debug, Default)]
struct StandIn {
    domain: Domain,
    displacement: Vec<Vector3<f64>>,
    /// For each island whether something moves there.
    moves: Vec<bool>,
}

impl StandIn {
    /// Finds the islands in which something moves in the end.
    fn find_moving(&mut self, islands: &Islands, responder: &Responder) {
        let Corrections { touched, forces, .. } = responder.corrections();
        self.moves.clear();
        self.moves.resize(islands.len() + 1, false);
        for &vertex in touched {
            self.moves[islands.of(vertex)] |= forces[vertex.index()] != Vector3::zeros();
        }
    }

    /// Puts the forces of one step where a proposal moves nothing, as far as they do no harm. False where it moves
    /// something everywhere, and corrections are as they were.
    fn stand_in(
        &mut self,
        view: &AnalysedFrame<'_>,
        scene: &Scene<'_>,
        methods: &mut Methods,
        responder: &mut Responder,
        should_stop: &dyn Fn() -> bool,
    ) -> bool {
        let AnalysedFrame { mesh, frame, analysis, settings, .. } = *view;
        let Scene { islands, now, .. } = *scene;
        let (domain, displacement) = methods.found();
        let Self { domain: both, displacement: steps, moves } = self;
        moves.clear();
        moves.resize(islands.len() + 1, false);
        for (&vertex, step) in domain.vertices().iter().zip(displacement) {
            moves[islands.of(vertex)] |= *step != Vector3::zeros();
        }
        let stands = |island: usize| !now.islands[island].is_none() && !moves[island];
        if !(0..now.islands.len()).any(stands) {
            return false;
        }
        responder.respond_as(Response::Rbf, mesh, frame, analysis, settings);
        let forces = responder.corrections();
        both.grow(mesh, domain.vertices().iter().chain(&forces.touched).copied(), 0);
        let step = |&vertex: &VertexId| match domain.local(vertex) {
            _ if stands(islands.of(vertex)) => step_of(mesh, forces, vertex),
            Some(local) => displacement[local],
            None => Vector3::zeros(),
        };
        steps.clear();
        steps.extend(both.vertices().iter().map(step));
        match methods.line_search.shorten(scene, both, steps, should_stop) {
            Verdict::Unjudged => {
                let (domain, displacement) = methods.found();
                responder.displace(mesh, domain.vertices(), displacement);
            }
            Verdict::Harmless | Verdict::Shortened => responder.displace(mesh, both.vertices(), steps),
        }
        true
    }
}
