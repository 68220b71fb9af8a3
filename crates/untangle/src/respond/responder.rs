//! From the analysis of a frame to its corrections.

use nalgebra::Vector3;

use super::{
    Corrections, LeftOut, VertexFlags,
    flags::set_flags,
    forces::{Gap, mass_kg},
    path_forces::{AnalysedFrame, PathForces},
};
use crate::{
    analysis::Analysis,
    correspond::{Correspondences, Correspondent},
    frame::Frame,
    labels::Labeller,
    mesh::{Mesh, MeshIdentity, VertexId},
    regions::starts_pair,
    settings::{Response, Settings},
    stage::{Stage, StageObserver},
};

/// Computes corrections, reusing its memory from frame to frame.
#[derive(Debug, Default)]
pub struct Responder {
    corrections: Corrections,
    correspondent: Correspondent,
    path_forces: PathForces,
    gap: Gap,
    /// Scratch of the flags.
    front: Vec<VertexId>,
    /// The mesh that the corrections are of.
    identity: Option<MeshIdentity>,
    labeller: Labeller,
    is_labelled: bool,
    /// Copies in the order of work that the last frame had time for.
    num_done: usize,
}

impl Responder {
    /// Switches labels on or off, from the next frame on: they are found only where somebody asks for them.
    pub fn set_labelled(&mut self, is_labelled: bool) {
        self.is_labelled = is_labelled;
    }

    /// Whether labels are found.
    #[must_use]
    pub fn is_labelled(&self) -> bool {
        self.is_labelled
    }

    /// Computes the corrections of one frame from its analysis.
    pub fn respond(
        &mut self,
        mesh: &Mesh,
        frame: &Frame,
        analysis: &Analysis,
        settings: &Settings,
        observer: &mut dyn StageObserver,
    ) -> &Corrections {
        if self.identity.as_ref() == Some(mesh.identity()) {
            self.corrections.reset();
        } else {
            self.corrections.begin(mesh);
            self.identity = Some(mesh.identity().clone());
        }
        observer.begin(Stage::Correspond);
        let (found, mut num_done) = match settings.response {
            Response::Rbf | Response::Displacement | Response::Coupled => {
                let found = self.correspondent.find(mesh, frame, analysis, settings, observer);
                (found, found.num_done)
            }
            Response::Contour | Response::Mask => (self.correspondent.clear(), analysis.regions.num_done),
        };
        self.num_done = num_done;
        observer.begin(Stage::Respond);
        set_flags(mesh, analysis, settings.path_rings, &mut self.corrections, &mut self.front);
        if self.is_labelled {
            self.labeller.find(mesh, frame, analysis, settings, &mut self.corrections.labels);
        }
        let gap_m = settings.gap_m().filter(|_| matches!(settings.response, Response::Rbf | Response::Contour));
        let mut is_gap_known = true;
        let has_forces = !matches!(settings.response, Response::Mask | Response::Coupled);
        if has_forces && (gap_m.is_some() || !analysis.paths.copies.is_empty()) {
            let view = AnalysedFrame { mesh, frame, analysis, settings };
            num_done = self.path_forces.sum(&view, found, num_done, observer);
            if let Some(gap_m) = gap_m {
                is_gap_known = self.find_gap(mesh, frame, gap_m, &mut || observer.is_spent());
                self.path_forces.keep_gap(&view, &mut self.gap, gap_m);
            }
            self.path_forces.finish(mesh, frame, &mut self.corrections);
            self.corrections.keep_finite();
        }
        self.corrections.left_out = LeftOut { gap: !is_gap_known, ..LeftOut::after(analysis, num_done) };
        self.corrections.list_touched();
        observer.end();
        &self.corrections
    }

    /// Replaces the values of the corrections by those of another response to the same frame, of one that has the same
    /// correspondences. Flags and labels stay, but for `CLAMPED`.
    pub(crate) fn respond_as(
        &mut self,
        response: Response,
        mesh: &Mesh,
        frame: &Frame,
        analysis: &Analysis,
        settings: &Settings,
    ) {
        let settings = Settings { response, ..settings.clone() };
        self.corrections.clear_values();
        let view = AnalysedFrame { mesh, frame, analysis, settings: &settings };
        self.path_forces.sum(&view, self.correspondent.found(), self.num_done, &mut ());
        self.path_forces.finish(mesh, frame, &mut self.corrections);
        self.corrections.keep_finite();
        self.corrections.list_touched();
    }

    /// Replaces the values of the corrections by displacements of one step, in metres, one for each of some vertices.
    pub(crate) fn displace(&mut self, mesh: &Mesh, vertices: &[VertexId], displacements: &[Vector3<f64>]) {
        let Self { corrections, .. } = self;
        corrections.clear_values();
        for (&vertex, displacement) in vertices.iter().zip(displacements) {
            if *displacement != Vector3::zeros() {
                *corrections.force_mut(vertex) = displacement * mass_kg(mesh, vertex);
                corrections.max_displacement_m = corrections.max_displacement_m.max(displacement.norm());
            }
        }
        corrections.list_touched();
    }

    /// Finds what is nearer than the gap and in no tangle by its flags. False, and nothing, where it can't be known.
    fn find_gap(&mut self, mesh: &Mesh, frame: &Frame, gap_m: f64, is_spent: &mut dyn FnMut() -> bool) -> bool {
        let Self { gap, corrections, .. } = self;
        gap.find(mesh, frame, gap_m, |vertex| corrections.is_untangled(vertex), is_spent)
    }

    /// Finds the displacements that keep a gap, one for each of some vertices, ascending, in metres: of vertices that
    /// are in no tangle by their flags, and have no displacement. None, and so noted in the corrections, where time is
    /// up.
    pub(crate) fn find_gap_displacements(
        &mut self,
        mesh: &Mesh,
        frame: &Frame,
        gap_m: f64,
        should_stop: &dyn Fn() -> bool,
    ) -> impl Iterator<Item = (VertexId, Vector3<f64>)> {
        self.corrections.left_out.gap = !self.find_gap(mesh, frame, gap_m, &mut || should_stop());
        let Self { gap, corrections, .. } = self;
        gap.displacements(mesh, gap_m, |vertex| corrections.forces[vertex.index()] != Vector3::zeros())
    }

    /// Notes that nothing is kept apart.
    pub(crate) fn leave_out_gap(&mut self) {
        self.corrections.left_out.gap = true;
    }

    /// Adds displacements of one step, in metres, one for each of some vertices, to those that corrections are.
    pub(crate) fn add_displacements(&mut self, mesh: &Mesh, vertices: &[VertexId], displacements: &[Vector3<f64>]) {
        let Self { corrections, .. } = self;
        for (&vertex, displacement) in vertices.iter().zip(displacements) {
            *corrections.force_mut(vertex) += displacement * mass_kg(mesh, vertex);
            corrections.max_displacement_m = corrections.max_displacement_m.max(displacement.norm());
        }
        corrections.list_touched();
    }

    /// Takes the mask and the labels away from some vertices.
    pub(crate) fn unmask(&mut self, is_unmasked: impl Fn(VertexId) -> bool) {
        let Corrections { touched, flags, labels, .. } = &mut self.corrections;
        for &vertex in touched.iter().filter(|&&vertex| is_unmasked(vertex)) {
            flags[vertex.index()].0 &= !(VertexFlags::INSIDE.0 | VertexFlags::NEAR_PATH.0);
        }
        labels.retain(|label| !is_unmasked(label.vertex));
        self.corrections.list_touched();
    }

    /// The last corrections.
    #[must_use]
    pub fn corrections(&self) -> &Corrections {
        &self.corrections
    }

    /// The correspondences behind the last corrections.
    #[must_use]
    pub fn correspondences(&self) -> &Correspondences {
        self.correspondent.found()
    }
}

impl LeftOut {
    /// All pairs after the first `num_done` copies in the order of work.
    fn after(analysis: &Analysis, num_done: usize) -> Self {
        let Analysis { paths, regions, .. } = analysis;
        let mut left_out = Self::default();
        for place in num_done..regions.order.len() {
            if starts_pair(paths, &regions.order, place) {
                left_out.num_pairs += 1;
                left_out.length_m += paths.pairs[paths.copies[regions.order[place]].pair].length_m;
            }
        }
        left_out
    }
}
