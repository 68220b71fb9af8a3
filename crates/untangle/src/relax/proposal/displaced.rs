//! The displacement to the targets, and those of the states that it leads to, as long as they help.

use nalgebra::Vector3;

use super::{
    line_search::{LineSearch, Scene, Standing, Verdict},
    values::{step_of, take},
};
use crate::{
    analysis::Analyser,
    frame::Frame,
    intersect::SearchEnd,
    mesh::VertexId,
    relax::{energy::Domain, settings::StopObserver, step::sent},
    respond::{Corrections, Responder},
    settings::Settings,
};

/// Most displacements after the first.
const MAX_STEPS: usize = 7;
/// Each has to leave at most this part of the tangle: a host whose cloth is moved far for little springs back.
const MOST_LEFT: f64 = 0.9;

/// Finds displacements to targets, reusing its memory.
#[derive(Debug, Default)]
pub(super) struct Displaced {
    /// The vertices that move, and what it does to them, as it will be sent.
    pub(super) domain: Domain,
    pub(super) displacement: Vec<Vector3<f64>>,
    /// The same with one more displacement, and the state that it begins at.
    next_domain: Domain,
    next_displacement: Vec<Vector3<f64>>,
    frame: Frame,
    analyser: Analyser,
    responder: Responder,
    standing: Standing,
}

impl Displaced {
    /// Takes the displacement that corrections are, and shortens it where it does harm. Then adds the displacement of
    /// the state that this leads to, and so on, until nothing intersects there, one hardly helps, or time is up. What
    /// is added is judged, and shortened, with all that was before it.
    ///
    /// Harmless is what the corrections are. Cost: that of [`LineSearch::shorten`], and for each displacement that is
    /// added an analysis and a response as well.
    pub(super) fn find(
        &mut self,
        scene: &Scene<'_>,
        settings: &Settings,
        corrections: &Corrections,
        line_search: &mut LineSearch,
        should_stop: &dyn Fn() -> bool,
    ) -> Verdict {
        take(scene.mesh, corrections, &mut self.domain, &mut self.displacement);
        let mut verdict = line_search.shorten(scene, &self.domain, &mut self.displacement, should_stop);
        if verdict == Verdict::Unjudged {
            return verdict;
        }
        for _ in 0..MAX_STEPS {
            let merit = line_search.standing.merit;
            if merit <= 0.0 || should_stop() || !self.add(scene, settings, should_stop) {
                break;
            }
            std::mem::swap(&mut self.standing, &mut line_search.standing);
            let next = line_search.shorten(scene, &self.next_domain, &mut self.next_displacement, should_stop);
            if next == Verdict::Unjudged || line_search.standing.merit > MOST_LEFT * merit {
                std::mem::swap(&mut self.standing, &mut line_search.standing);
                break;
            }
            std::mem::swap(&mut self.domain, &mut self.next_domain);
            std::mem::swap(&mut self.displacement, &mut self.next_displacement);
            verdict = Verdict::Shortened;
        }
        verdict
    }

    /// Adds the displacement of the state that the present one leads to. False where that state can't be analysed.
    fn add(&mut self, scene: &Scene<'_>, settings: &Settings, should_stop: &dyn Fn() -> bool) -> bool {
        let Scene { mesh, frame, precision, .. } = *scene;
        let Self { domain, displacement, .. } = self;
        let place = |vertex: VertexId| match domain.local(vertex) {
            Some(local) => precision.moved(frame.position(vertex), displacement[local]),
            None => frame.position(vertex),
        };
        let places = (0..mesh.num_vertices()).map(|index| place(VertexId::from_index(index)).into());
        if self.frame.set::<f64>(mesh, places).is_err() {
            return false;
        }
        let mut observer = StopObserver(should_stop);
        self.analyser.analyse(mesh, &self.frame, settings, &mut observer);
        if self.analyser.search_end() != SearchEnd::Complete {
            return false;
        }
        let further = self.responder.respond(mesh, &self.frame, self.analyser.last(), settings, &mut observer);
        let moved = |vertex: &&VertexId| step_of(mesh, further, **vertex) != Vector3::zeros();
        self.next_domain.grow(mesh, domain.vertices().iter().chain(further.touched.iter().filter(moved)).copied(), 0);
        let before = |vertex: VertexId| domain.local(vertex).map_or(Vector3::zeros(), |local| displacement[local]);
        let both = |&vertex: &VertexId| sent(before(vertex) + step_of(mesh, further, vertex));
        self.next_displacement.clear();
        self.next_displacement.extend(self.next_domain.vertices().iter().map(both));
        true
    }
}
