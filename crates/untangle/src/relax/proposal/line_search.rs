//! The line search of a proposal: what makes an island of paths worse is shortened there, and stopped at last.

use nalgebra::{Point3, Vector3};

use super::judge::{Judge, Judgement, Merits};
use crate::{
    frame::Frame,
    intersect::SearchLimits,
    mesh::{Mesh, VertexId},
    relax::{
        energy::Domain,
        step::{Backtracking, Damping, Islands, Precision, sent},
    },
};

/// Where a proposal does harm it is made at 1, 1/2 and 1/4, and then not at all. Islands that only do harm once others
/// stand still get some rounds more.
const BACKTRACKING: Backtracking = Backtracking { halvings: 2, stops: 10 };

/// What a proposal is for.
#[derive(Clone, Copy)]
pub(super) struct Scene<'a> {
    pub(super) mesh: &'a Mesh,
    pub(super) frame: &'a Frame,
    pub(super) islands: &'a Islands,
    /// How tangled the frame is.
    pub(super) now: &'a Merits,
    pub(super) precision: Precision,
    pub(super) limits: SearchLimits,
}

/// What became of a proposal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Verdict {
    /// It makes nothing worse as it is.
    Harmless,
    /// It makes nothing worse now that it was shortened.
    Shortened,
    /// Time was up before it could be judged.
    Unjudged,
}

/// Shortens proposals, reusing its memory.
#[derive(Debug, Default)]
pub(super) struct LineSearch {
    judge: Judge,
    damping: Damping,
    positions: Vec<Point3<f64>>,
    is_worse: Vec<bool>,
    damped: Vec<usize>,
    /// Where the displacement that was shortened last leads.
    pub(super) standing: Standing,
}

/// How tangled a state is that a displacement leads to.
#[derive(Debug, Default)]
pub(super) struct Standing {
    pub(super) merit: f64,
    /// For each island whether nothing intersects there any more; empty where nothing moves, or it was not judged.
    cleared: Vec<bool>,
}

impl LineSearch {
    /// Shortens a displacement over a domain, given as it will be sent, until it leaves no island more tangled than it
    /// is, and nothing else either. At the border of an island that is held back the displacement fades.
    ///
    /// Cost: one search for intersections where it does no harm, at most twelve.
    pub(super) fn shorten(
        &mut self,
        scene: &Scene<'_>,
        domain: &Domain,
        displacement: &mut [Vector3<f64>],
        should_stop: &dyn Fn() -> bool,
    ) -> Verdict {
        let Scene { mesh, frame, islands, limits, .. } = *scene;
        let vertices = domain.vertices();
        self.damping.reset(vertices.len());
        self.positions.clear();
        self.positions.extend_from_slice(frame.positions());
        self.standing.cleared.clear();
        self.standing.merit = scene.now.all.merit();
        for round in 0..BACKTRACKING.num_rounds() {
            if should_stop() {
                return Verdict::Unjudged;
            }
            for (local, &vertex) in vertices.iter().enumerate() {
                let step = displacement[local] * self.damping.factor(local);
                self.positions[vertex.index()] = scene.precision.moved(frame.position(vertex), step);
            }
            let judgement = self.judge.judge(mesh, &self.positions, islands, limits, should_stop);
            if judgement == Judgement::OutOfTime {
                return Verdict::Unjudged;
            }
            if judgement == Judgement::Done && !self.find_worse(scene) {
                self.stand(scene);
                if round == 0 {
                    return Verdict::Harmless;
                }
                for (local, step) in displacement.iter_mut().enumerate() {
                    *step = sent(*step * self.damping.factor(local));
                }
                return Verdict::Shortened;
            }
            self.collect_worse(domain, displacement, islands);
            if judgement == Judgement::Done && self.damped.is_empty() {
                // Nothing moves where the harm is, so it comes from the islands that meet it there.
                self.judge.spread_worse(mesh, islands, &mut self.is_worse);
                self.collect_worse(domain, displacement, islands);
            }
            if judgement == Judgement::Refused || self.damped.is_empty() {
                self.damped.clear();
                self.damped.extend(0..vertices.len());
            }
            self.damping.damp(mesh, domain, self.damped.iter().copied(), BACKTRACKING.factor(round));
        }
        displacement.fill(Vector3::zeros());
        Verdict::Shortened
    }

    /// Takes note of where the state that was judged last stands.
    fn stand(&mut self, scene: &Scene<'_>) {
        let Merits { islands, all } = &self.judge.merits;
        let pairs = islands.iter().zip(&scene.now.islands);
        self.standing.cleared.extend(pairs.map(|(after, now)| after.is_none() && !now.is_none()));
        self.standing.merit = all.merit();
    }

    /// Whether a vertex lies in an island in which the displacement that was shortened last leaves nothing that
    /// intersects; not where it could not be judged.
    pub(super) fn is_cleared(&self, islands: &Islands, vertex: VertexId) -> bool {
        self.standing.cleared.get(islands.of(vertex)).is_some_and(|&is_cleared| is_cleared)
    }

    /// Collects the vertices that move in islands that get worse.
    fn collect_worse(&mut self, domain: &Domain, displacement: &[Vector3<f64>], islands: &Islands) {
        let Self { damping, is_worse, damped, .. } = self;
        let moves = |local: usize| displacement[local] != Vector3::zeros() && damping.factor(local) > 0.0;
        let worse = |local: usize| is_worse[islands.of(domain.vertices()[local])];
        damped.clear();
        damped.extend((0..domain.vertices().len()).filter(|&local| moves(local) && worse(local)));
    }

    /// Finds the islands that the judged state leaves more tangled than they are. False if there are none, and all
    /// together is not more tangled either.
    fn find_worse(&mut self, scene: &Scene<'_>) -> bool {
        let after = &self.judge.merits;
        let pairs = after.islands.iter().zip(&scene.now.islands);
        self.is_worse.clear();
        self.is_worse.extend(pairs.map(|(after, now)| after.merit() > now.merit()));
        let any = self.is_worse.contains(&true);
        if !any && after.all.merit() > scene.now.all.merit() {
            self.is_worse.fill(true);
            return true;
        }
        any
    }
}
