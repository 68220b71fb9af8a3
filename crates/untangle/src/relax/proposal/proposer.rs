//! Which displacements are tried for a frame, and what goes out.

use std::cell::RefCell;

use nalgebra::Vector3;

use super::{
    coupled::Coupled,
    judge::Merits,
    line_search::{LineSearch, Scene, Verdict},
    trials::REACH,
};
use crate::{
    analysis::Analysis,
    frame::Frame,
    intersect::SearchLimits,
    mesh::{Mesh, VertexId},
    relax::{
        energy::Domain,
        step::{Islands, Precision, sent},
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
}

/// Judges displacements before they go out, reusing its memory from frame to frame.
///
/// What makes an island of paths worse is shortened there, and where nothing is left of it the forces of one step stand
/// in, which are judged too; where these do harm as well nothing moves. So no frame leads to a state that is more
/// tangled, in intersections and path lengths together, than its own.
#[derive(Debug, Default)]
pub(crate) struct Proposer {
    coupled: Coupled,
    line_search: LineSearch,
    islands: Islands,
    now: Merits,
    /// The vertices of the proposal, and what it does to them, as it will be sent.
    domain: Domain,
    displacement: Vec<Vector3<f64>>,
    forces: StandIn,
}

impl Proposer {
    /// Replaces the values of the corrections, which are those of the response `displacement`, or none for `coupled`,
    /// by a displacement that does no harm. Where they do none, values of `displacement` stay to the bit.
    ///
    /// Where time is up before anything could be judged, the forces of one step go out in their place.
    ///
    /// Cost: nothing where nothing intersects; else that of [`LineSearch::shorten`], twice where something is stopped,
    /// and for `coupled` that of [`Coupled::find`]. Only that one allocates once this is warm.
    pub(crate) fn propose(
        &mut self,
        view: &AnalysedFrame<'_>,
        responder: &mut Responder,
        observer: &mut dyn StageObserver,
    ) {
        let AnalysedFrame { mesh, frame, analysis, settings, is_single } = *view;
        if analysis.paths.copies.is_empty() {
            return;
        }
        self.islands.find(mesh, analysis, &[], REACH);
        self.now.measure(mesh, frame, &analysis.intersections, &self.islands);
        let Self { islands, now, coupled, line_search, forces, .. } = self;
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
        let (domain, displacement) = if settings.response == Response::Coupled {
            let is_judged = coupled.find(&scene, analysis, responder.correspondences(), settings, &should_stop);
            if !is_judged {
                responder.respond_as(Response::Rbf, mesh, frame, analysis, settings);
                return;
            }
            (&coupled.domain, &mut coupled.displacement)
        } else {
            take(mesh, responder.corrections(), &mut self.domain, &mut self.displacement);
            (&self.domain, &mut self.displacement)
        };
        let verdict = line_search.shorten(&scene, domain, displacement, &should_stop);
        if verdict == Verdict::Unjudged {
            responder.respond_as(Response::Rbf, mesh, frame, analysis, settings);
            return;
        }
        let proposal = Proposal { domain, displacement };
        let stood_in = !should_stop() && forces.stand_in(view, &scene, &proposal, line_search, responder, &should_stop);
        if !stood_in && (verdict == Verdict::Shortened || settings.response == Response::Coupled) {
            responder.displace(mesh, domain.vertices(), displacement);
        }
    }
}

/// A displacement that does no harm.
struct Proposal<'a> {
    domain: &'a Domain,
    displacement: &'a [Vector3<f64>],
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
    /// Puts the forces of one step where a proposal moves nothing, as far as they do no harm. False where it moves
    /// something everywhere, and corrections are as they were.
    fn stand_in(
        &mut self,
        view: &AnalysedFrame<'_>,
        scene: &Scene<'_>,
        proposal: &Proposal<'_>,
        line_search: &mut LineSearch,
        responder: &mut Responder,
        should_stop: &dyn Fn() -> bool,
    ) -> bool {
        let AnalysedFrame { mesh, frame, analysis, settings, .. } = *view;
        let Scene { islands, now, .. } = *scene;
        let Proposal { domain, displacement } = *proposal;
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
        match line_search.shorten(scene, both, steps, should_stop) {
            Verdict::Unjudged => responder.displace(mesh, domain.vertices(), displacement),
            Verdict::Harmless | Verdict::Shortened => responder.displace(mesh, both.vertices(), steps),
        }
        true
    }
}

/// Takes the vertices that corrections move, and what they do to them, as it will be sent.
fn take(mesh: &Mesh, corrections: &Corrections, domain: &mut Domain, displacement: &mut Vec<Vector3<f64>>) {
    let moved = |vertex: &VertexId| step_of(mesh, corrections, *vertex) != Vector3::zeros();
    domain.grow(mesh, corrections.touched.iter().copied().filter(moved), 0);
    displacement.clear();
    displacement.extend(domain.vertices().iter().map(|&vertex| step_of(mesh, corrections, vertex)));
}

/// The displacement of one step that a force makes, as it will be sent; none without mass.
fn step_of(mesh: &Mesh, corrections: &Corrections, vertex: VertexId) -> Vector3<f64> {
    let mass_kg = mesh.masses_kg().map_or(1.0, |masses| masses[vertex.index()]);
    if mass_kg > 0.0 { sent(corrections.forces[vertex.index()] * (1.0 / mass_kg)) } else { Vector3::zeros() }
}
