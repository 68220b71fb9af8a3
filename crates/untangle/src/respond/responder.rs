//! From the analysis of a frame to its corrections.

use nalgebra::Vector3;

use super::{
    Corrections, LeftOut, VertexFlags,
    flags::set_flags,
    forces::mass_kg,
    path_forces::{AnalysedFrame, PathForces},
};
use crate::{
    analysis::Analysis,
    correspond::{Correspondences, Correspondent},
    frame::Frame,
    labels::Labeller,
    mesh::{Mesh, VertexId},
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
    /// Scratch of the flags.
    front: Vec<VertexId>,
    labeller: Labeller,
    is_labelled: bool,
}

impl Responder {
    /// Switches labels on or off, from the next frame on: they are found only where somebody asks for them.
    pub fn set_labelled(&mut self, is_labelled: bool) {
        self.is_labelled = is_labelled;
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
        self.corrections.reset(mesh.num_vertices());
        observer.begin(Stage::Correspond);
        let (found, mut num_done) = match settings.response {
            Response::Rbf | Response::Displacement | Response::Coupled => {
                let found = self.correspondent.find(mesh, frame, analysis, settings, observer);
                (found, found.num_done)
            }
            Response::Contour | Response::Mask => (self.correspondent.clear(), analysis.regions.num_done),
        };
        observer.begin(Stage::Respond);
        set_flags(mesh, analysis, settings.path_rings, &mut self.corrections.flags, &mut self.front);
        if self.is_labelled {
            self.labeller.find(mesh, frame, analysis, settings, &mut self.corrections.labels);
        }
        if !matches!(settings.response, Response::Mask | Response::Coupled) && !analysis.paths.copies.is_empty() {
            let view = AnalysedFrame { mesh, frame, analysis, settings };
            num_done = self.path_forces.sum(&view, found, num_done, observer);
            self.path_forces.finish(mesh, frame, &mut self.corrections);
            self.corrections.keep_finite();
        }
        self.corrections.left_out = LeftOut::after(analysis, num_done);
        observer.end();
        &self.corrections
    }

    /// The correspondences behind the last corrections, and a way to add displacements of one step, in metres, to these
    /// corrections.
    pub(crate) fn displacement_adder<'a>(
        &'a mut self,
        mesh: &'a Mesh,
    ) -> (&'a Correspondences, impl FnMut(VertexId, Vector3<f64>)) {
        let Self { corrections, correspondent, .. } = self;
        let add = move |vertex: VertexId, displacement: Vector3<f64>| {
            corrections.forces[vertex.index()] += displacement * mass_kg(mesh, vertex);
            corrections.max_displacement_m = corrections.max_displacement_m.max(displacement.norm());
        };
        (correspondent.found(), add)
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

impl Corrections {
    /// Leaves out forces that are not finite: settings and masses at the limits of floating point can make such.
    fn keep_finite(&mut self) {
        let is_finite = |vector: &Vector3<f64>| vector.iter().all(|value| value.is_finite());
        for force in self.forces.iter_mut().filter(|force| !is_finite(force)) {
            *force = Vector3::zeros();
        }
        for sum in [&mut self.net_force, &mut self.net_torque] {
            if !is_finite(sum) {
                *sum = Vector3::zeros();
            }
        }
        if !self.max_displacement_m.is_finite() {
            self.max_displacement_m = 0.0;
        }
    }

    fn reset(&mut self, num_vertices: usize) {
        self.forces.clear();
        self.forces.resize(num_vertices, Vector3::zeros());
        self.flags.clear();
        self.flags.resize(num_vertices, VertexFlags::default());
        self.labels.clear();
        self.net_force = Vector3::zeros();
        self.net_torque = Vector3::zeros();
        self.max_displacement_m = 0.0;
        self.left_out = LeftOut::default();
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
