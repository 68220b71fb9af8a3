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
        if !matches!(settings.response, Response::Mask | Response::Coupled) && !analysis.paths.copies.is_empty() {
            let view = AnalysedFrame { mesh, frame, analysis, settings };
            num_done = self.path_forces.sum(&view, found, num_done, observer);
            self.path_forces.finish(mesh, frame, &mut self.corrections);
            self.corrections.keep_finite();
        }
        self.corrections.left_out = LeftOut::after(analysis, num_done);
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

impl Corrections {
    /// Sets flags of a vertex.
    pub(crate) fn flag(&mut self, vertex: VertexId, flags: VertexFlags) {
        self.touch(vertex);
        self.flags[vertex.index()].insert(flags);
    }

    /// The force on a vertex, to be changed.
    pub(crate) fn force_mut(&mut self, vertex: VertexId) -> &mut Vector3<f64> {
        self.touch(vertex);
        &mut self.forces[vertex.index()]
    }

    /// Notes a vertex whose force or flags are about to change. One that has either is noted already.
    fn touch(&mut self, vertex: VertexId) {
        if !self.is_touched(vertex) {
            self.touched.push(vertex);
        }
    }

    fn is_touched(&self, vertex: VertexId) -> bool {
        let VertexFlags(flags) = self.flags[vertex.index()];
        // By its bits, so that a negative zero does not stay for the next frame.
        flags & !VertexFlags::PINNED.0 != 0 || self.forces[vertex.index()].iter().any(|value| value.to_bits() != 0)
    }

    /// Lists the vertices that have a force or a flag other than pinned, each once, in order.
    ///
    /// Cost: a sort of the list; nothing where it is empty.
    fn list_touched(&mut self) {
        let mut touched = std::mem::take(&mut self.touched);
        touched.sort_unstable();
        touched.dedup();
        touched.retain(|&vertex| self.is_touched(vertex));
        self.touched = touched;
        debug_assert_eq!(
            (0..self.forces.len()).filter(|&index| self.is_touched(VertexId::from_index(index))).count(),
            self.touched.len(),
            "a force or a flag was set past `force_mut` and `flag`"
        );
    }

    /// Leaves out forces that are not finite: settings and masses at the limits of floating point can make such.
    fn keep_finite(&mut self) {
        let is_finite = |vector: &Vector3<f64>| vector.iter().all(|value| value.is_finite());
        for vertex in &self.touched {
            let force = &mut self.forces[vertex.index()];
            if !is_finite(force) {
                *force = Vector3::zeros();
            }
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

    /// Makes all values zero. Flags stay, but for that of values that were limited.
    ///
    /// Cost: linear in the vertices that were touched.
    fn clear_values(&mut self) {
        for vertex in &self.touched {
            self.forces[vertex.index()] = Vector3::zeros();
            self.flags[vertex.index()].0 &= !VertexFlags::CLAMPED.0;
        }
        self.net_force = Vector3::zeros();
        self.net_torque = Vector3::zeros();
        self.max_displacement_m = 0.0;
    }

    /// Makes them those of a mesh, all zero but for the flags of pinned vertices.
    fn begin(&mut self, mesh: &Mesh) {
        self.forces.clear();
        self.forces.resize(mesh.num_vertices(), Vector3::zeros());
        let pinned = |vertex| if mesh.is_pinned(vertex) { VertexFlags::PINNED } else { VertexFlags::default() };
        self.flags.clear();
        self.flags.extend(mesh.vertex_ids().map(pinned));
        self.touched.clear();
        self.reset();
    }

    /// Makes them what they were at the beginning.
    ///
    /// Cost: linear in the vertices that were touched.
    fn reset(&mut self) {
        for vertex in self.touched.drain(..) {
            self.forces[vertex.index()] = Vector3::zeros();
            self.flags[vertex.index()].0 &= VertexFlags::PINNED.0;
        }
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
