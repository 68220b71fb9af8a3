//! From the analysis of a frame to its corrections: which method acts on which path.

use nalgebra::Vector3;

use super::{
    Corrections, LeftOut, VertexFlags,
    contour::{GUARD, length_gradient},
    displace::Displacements,
    flags::set_flags,
    forces::{ForceLaw, Forces, mass_at, mass_kg},
    push::{BoundaryPush, PushedPath},
};
use crate::{
    analysis::Analysis,
    correspond::{Correspondences, Correspondent, MaterialPoint, PathCorrespondence},
    frame::Frame,
    geometry::mean_edge_length,
    mesh::{Mesh, VertexId},
    paths::{PathSegment, PathType, Sheet},
    regions::starts_pair,
    settings::{Response, Settings},
    stage::{Stage, StageObserver},
};

/// Points of a path stand for the force of this many vertices, per edge length of path. Without them regions of few vertices stay:
/// of 0, 0.5, 1, 2 and 4, tried on one set of small scenes, 0 and 0.5 left two scenes tangled within 100 steps; from 1 on little changed.
const PARTING_WEIGHT: f64 = 2.0;
/// The same for the points of a BI path.
const PUSH_WEIGHT: f64 = 2.0;

/// Computes corrections, reusing its memory from frame to frame.
#[derive(Debug, Default)]
pub struct Responder {
    corrections: Corrections,
    correspondent: Correspondent,
    forces: Forces,
    push: BoundaryPush,
    steps: [Vec<Vector3<f64>>; 2],
    /// Paths with targets that are pushed over a boundary instead.
    pushed: Vec<usize>,
    displacements: Displacements,
    front: Vec<VertexId>,
}

/// What does not change while one frame is answered.
#[derive(Clone, Copy)]
struct Scene<'a> {
    mesh: &'a Mesh,
    frame: &'a Frame,
    analysis: &'a Analysis,
    settings: &'a Settings,
}

impl Responder {
    /// Computes the corrections of one frame from its analysis.
    pub fn respond(
        &mut self,
        mesh: &Mesh,
        frame: &Frame,
        analysis: &Analysis,
        settings: &Settings,
        observer: &mut dyn StageObserver,
    ) -> &Corrections {
        let num_vertices = mesh.num_vertices();
        self.corrections.reset(num_vertices);
        let scene = Scene { mesh, frame, analysis, settings };
        observer.begin(Stage::Correspond);
        let found = match settings.response {
            Response::Rbf | Response::Displacement | Response::Coupled => {
                self.correspondent.find(mesh, frame, analysis, settings, observer)
            }
            Response::Contour | Response::Mask => self.correspondent.clear(),
        };
        let order = &analysis.regions.order;
        let mut num_done = match settings.response {
            Response::Rbf | Response::Displacement | Response::Coupled => found.num_done,
            Response::Contour | Response::Mask => analysis.regions.num_done,
        };
        observer.begin(Stage::Respond);
        set_flags(mesh, analysis, settings.path_rings, &mut self.corrections.flags, &mut self.front);
        if !matches!(settings.response, Response::Mask | Response::Coupled) && !analysis.paths.copies.is_empty() {
            self.push.forget();
            self.forces.start(num_vertices);
            self.displacements.start(num_vertices);
            self.pushed.clear();
            for path in found.paths.iter().filter(|path| path.round && settings.response == Response::Rbf) {
                let partner = analysis.paths.copies[path.copy].partner;
                if path.copy < partner && push(&scene, path.copy, &mut self.push, &mut self.steps, &mut self.forces) {
                    self.pushed.extend([path.copy, partner]);
                }
            }
            for path in found.paths.iter().filter(|path| !self.pushed.contains(&path.copy)) {
                if settings.response == Response::Displacement {
                    let offset_m = law(settings, path.edge_length_m).offset_m;
                    let two_sided = has_correspondence(found, analysis.paths.copies[path.copy].partner);
                    self.displacements.follow(frame, found, path, offset_m, two_sided);
                } else {
                    follow_targets(&scene, found, path, &mut self.forces);
                }
            }
            for place in 0..num_done {
                // Where targets were looked for, pairs have had their turn: what costs little follows without asking again.
                let may_end = settings.response == Response::Contour && starts_pair(&analysis.paths, order, place);
                if may_end && observer.is_spent() {
                    num_done = place;
                    break;
                }
                let copy = order[place];
                if !is_unanswered(analysis, found, copy) {
                    continue;
                }
                let is_bi = analysis.paths.copies[copy].path_type == PathType::BoundaryInside;
                if settings.response != Response::Contour && is_bi {
                    push(&scene, copy, &mut self.push, &mut self.steps, &mut self.forces);
                }
                // Also beside the push: on the few BI scenes tried, shortening alone never resolved, and both were somewhat faster
                // than the push alone.
                shorten(&scene, copy, &mut self.forces);
            }
            self.forces.finish(mesh, frame, &mut self.corrections);
            self.displacements.finish(mesh, &mut self.corrections);
            self.corrections.keep_finite();
        }
        self.corrections.left_out = LeftOut::of(analysis, num_done);
        observer.end();
        &self.corrections
    }

    /// The correspondences behind the last corrections, and a way to add displacements of one step, in metres, to these corrections.
    pub(crate) fn displace<'a>(
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
    /// Settings and masses at the limits of floating point may ask for more than a number can hold: such a force is left out.
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
        self.net_force = Vector3::zeros();
        self.net_torque = Vector3::zeros();
        self.max_displacement_m = 0.0;
        self.left_out = LeftOut::default();
    }
}

impl LeftOut {
    /// All pairs after the first `num_done` copies in the order of work.
    fn of(analysis: &Analysis, num_done: usize) -> Self {
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

/// Whether neither a path nor its corresponding one has a correspondence; of such a pair only the first path.
fn is_unanswered(analysis: &Analysis, found: &Correspondences, copy: usize) -> bool {
    let partner = analysis.paths.copies[copy].partner;
    copy <= partner && !has_correspondence(found, copy) && !has_correspondence(found, partner)
}

fn has_correspondence(found: &Correspondences, copy: usize) -> bool {
    found.paths.binary_search_by_key(&copy, |path| path.copy).is_ok()
}

fn law(settings: &Settings, edge_length_m: f64) -> ForceLaw {
    ForceLaw {
        stiffness: settings.stiffness_per_step2,
        offset_m: 0.5 * settings.thickness_m.unwrap_or(edge_length_m),
        largest_m: settings.max_step_edge_lengths * edge_length_m,
    }
}

/// Forces between points inside and their targets, and between the sheets along the path.
fn follow_targets(scene: &Scene<'_>, found: &Correspondences, path: &PathCorrespondence, forces: &mut Forces) {
    let law = law(scene.settings, path.edge_length_m);
    for attraction in &found.attractions[path.attractions.clone()] {
        let way = attraction.target.position(scene.frame) - attraction.source.position(scene.frame);
        let distance = way.norm();
        // A point in its own target has no direction to go; the path beside it has.
        if distance > 1e-9 * path.edge_length_m {
            let size = mass_at(scene.mesh, &attraction.source) * law.step(distance);
            forces.add_pair(&attraction.source, &attraction.target, way * (size / distance), law.largest_m);
        }
    }
    for separation in &found.separations[path.separations.clone()] {
        let part = PARTING_WEIGHT * separation.length_m / path.edge_length_m;
        let size = mass_at(scene.mesh, &separation.own) * law.step(0.0) * part;
        forces.add_pair(&separation.own, &separation.partner, separation.direction * size, law.largest_m);
    }
}

/// Pushes a BI path and its partner over the nearest boundaries, or a pair of paths round tubes over the nearest hem: to slip one tube
/// out of the other takes no strain, to turn it inside out does. False where there is no telling which way.
fn push(
    scene: &Scene<'_>,
    copy: usize,
    push: &mut BoundaryPush,
    steps: &mut [Vec<Vector3<f64>>; 2],
    forces: &mut Forces,
) -> bool {
    let Scene { mesh, frame, analysis, settings } = *scene;
    let path = &analysis.paths.copies[copy];
    let round = path.closed;
    let points = &analysis.paths.points[path.points.clone()];
    let segments = &analysis.paths.segments[path.segments.clone()];
    let Some(edge_length_m) = mean_edge_length(mesh, frame, segments.iter().map(|segment| segment.own)) else {
        return false;
    };
    let law = law(settings, edge_length_m);
    let path = PushedPath { mesh, frame, points, segments, law, edge_length_m };
    let over_partner = push.steps(&path, Sheet::Partner, &mut steps[0]);
    let over_own = push.steps(&path, Sheet::Own, &mut steps[1]);
    if over_partner.is_none() && over_own.is_none() {
        return false;
    }
    if round && let (Some(partner), Some(own)) = (over_partner, over_own) {
        // Two tubes slip along each other: a push over the hem of each would be one to and one fro.
        steps[usize::from(partner <= own)].fill(Vector3::zeros());
    }
    for (index, segment) in segments.iter().enumerate() {
        let (start, end) = (&points[index], &points[index + 1]);
        let own = MaterialPoint::middle(mesh, segment.own, [&start.own, &end.own]);
        let partner = MaterialPoint::middle(mesh, segment.partner, [&start.partner, &end.partner]);
        if let (Some(own), Some(partner)) = (own, partner) {
            // The path goes over the partner's boundary, the partner over that of the path.
            let step = (steps[0][index] - steps[1][index]) * PUSH_WEIGHT;
            forces.add_pair(&own, &partner, step * mass_at(mesh, &own), law.largest_m);
        }
    }
    true
}

/// Contour minimisation for a path and its partner; nothing where the largest step has no limit.
fn shorten(scene: &Scene<'_>, copy: usize, forces: &mut Forces) {
    let Scene { mesh, frame, analysis, settings } = *scene;
    let path = &analysis.paths.copies[copy];
    let points = &analysis.paths.points[path.points.clone()];
    let segments = &analysis.paths.segments[path.segments.clone()];
    let Some(edge_length_m) = mean_edge_length(mesh, frame, segments.iter().map(|segment| segment.own)) else { return };
    let law = law(settings, edge_length_m);
    if law.largest_m.is_infinite() {
        // The gradient has no other size, and infinite ones would spoil what else acts on these vertices.
        return;
    }
    // A path that is its own partner runs twice over every point of the world.
    let share = if path.partner == copy { 0.5 } else { 1.0 };
    // One mass for all: only as a whole does the gradient keep momenta.
    let strength = -share * law.largest_m * mean_mass_kg(mesh, segments);
    length_gradient(mesh, frame, points, path.closed, GUARD, |vertex, gradient| {
        forces.add(vertex, gradient * strength, law.largest_m);
    });
}

/// Mean mass of the vertices of the faces that a path runs through; 1 kg where the mesh has none.
fn mean_mass_kg(mesh: &Mesh, segments: &[PathSegment]) -> f64 {
    let faces = segments.iter().flat_map(|segment| [segment.own, segment.partner]);
    let sum: f64 = faces.flat_map(|face| mesh.face(face)).map(|vertex| mass_kg(mesh, vertex)).sum();
    #[expect(clippy::cast_precision_loss, reason = "a count of segments")]
    let mean = sum / (6 * segments.len()) as f64;
    mean
}
