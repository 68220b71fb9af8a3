//! What acts on each path of a frame: attraction to targets, boundary push, contour minimisation.

use nalgebra::Vector3;

use super::{
    Corrections,
    boundary_push::{BoundaryPush, PushedPath},
    contour::{GUARD, length_gradient},
    displace::Displacements,
    forces::{Field, ForceLaw, Forces, Gap, Spread, limited, mass_at, mass_kg},
};
use crate::{
    analysis::Analysis,
    correspond::{Attraction, Correspondences, MaterialPoint, PathCorrespondence},
    frame::Frame,
    geometry::mean_edge_length,
    mesh::Mesh,
    paths::{PathPoint, PathSegment, PathType, Sheet},
    regions::starts_pair,
    settings::{Response, Settings},
    stage::StageObserver,
};

/// The separation constraints of a path act like this many vertices per edge length of path. Without them regions of
/// few vertices stay tangled: of 0, 0.5, 1, 2 and 4, tried on one set of small scenes, 0 and 0.5 left two scenes
/// tangled within 100 steps; from 1 on little changed.
const SEPARATION_WEIGHT: f64 = 2.0;
/// The same for the boundary push of a path.
const PUSH_WEIGHT: f64 = 2.0;

/// What does not change while the corrections of one frame are computed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AnalysedFrame<'a> {
    pub(crate) mesh: &'a Mesh,
    pub(crate) frame: &'a Frame,
    pub(crate) analysis: &'a Analysis,
    pub(crate) settings: &'a Settings,
}

/// Sums of the forces and displacements of all paths of a frame, reusing its memory.
#[derive(Debug, Default)]
pub(crate) struct PathForces {
    forces: Forces,
    displacements: Displacements,
    boundary_push: BoundaryPush,
    spread: Spread,
    /// For each segment of one path the steps over the boundary of the partner's sheet, and over that of its own.
    steps: [Vec<Vector3<f64>>; 2],
    /// Paths with targets that are pushed over a boundary instead.
    pushed: Vec<usize>,
}

impl PathForces {
    /// Sums up what acts on the paths of a frame. Pairs after the first `num_done` copies in the order of work are left
    /// out.
    ///
    /// Returns the number of copies that were processed: fewer only if the observer ended a contour minimisation.
    pub(crate) fn sum(
        &mut self,
        view: &AnalysedFrame<'_>,
        found: &Correspondences,
        num_done: usize,
        observer: &mut dyn StageObserver,
    ) -> usize {
        self.boundary_push.reset();
        self.forces.reset(view.mesh.num_vertices());
        self.displacements.reset(view.mesh.num_vertices());
        self.pushed.clear();
        if view.settings.response == Response::Rbf {
            self.push_tubes(view, found);
        }
        self.follow_targets(view, found);
        self.act_without_targets(view, found, num_done, observer)
    }

    /// Adds the forces that keep a gap.
    pub(crate) fn keep_gap(&mut self, view: &AnalysedFrame<'_>, gap: &mut Gap, thickness_m: f64) {
        gap.add_forces(view.mesh, view.frame, thickness_m, view.settings, &mut self.forces);
    }

    /// Writes the sums into corrections whose forces are zero.
    pub(crate) fn finish(&mut self, mesh: &Mesh, frame: &Frame, corrections: &mut Corrections) {
        self.forces.finish(mesh, frame, corrections);
        self.displacements.finish(mesh, corrections);
    }

    /// Pairs of paths round two tubes are pushed over a boundary, where one is near.
    fn push_tubes(&mut self, view: &AnalysedFrame<'_>, found: &Correspondences) {
        for path in found.paths.iter().filter(|path| path.round) {
            let partner = view.analysis.paths.copies[path.copy].partner;
            if path.copy < partner && self.push(view, path.copy) {
                self.pushed.extend([path.copy, partner]);
            }
        }
    }

    /// All other paths with targets follow these.
    fn follow_targets(&mut self, view: &AnalysedFrame<'_>, found: &Correspondences) {
        for path in found.paths.iter().filter(|path| !self.pushed.contains(&path.copy)) {
            if view.settings.response == Response::Displacement {
                let offset_m = ForceLaw::new(view.settings, path.edge_length_m, 0.0).offset_m;
                let two_sided = has_correspondence(found, view.analysis.paths.copies[path.copy].partner);
                self.displacements.add_path(view.frame, found, path, offset_m, two_sided);
            } else {
                attract(view, found, path, &mut self.forces);
            }
        }
    }

    /// Paths without targets are shortened, and pushed over a boundary where they end on one.
    fn act_without_targets(
        &mut self,
        view: &AnalysedFrame<'_>,
        found: &Correspondences,
        num_done: usize,
        observer: &mut dyn StageObserver,
    ) -> usize {
        let AnalysedFrame { analysis, settings, .. } = *view;
        let order = &analysis.regions.order;
        for place in 0..num_done {
            // Where targets were looked for, the observer was asked then, and what is cheap is done for all pairs that
            // have them.
            let may_end = settings.response == Response::Contour && starts_pair(&analysis.paths, order, place);
            if may_end && observer.is_spent() {
                return place;
            }
            let copy = order[place];
            if !is_unanswered(analysis, found, copy) {
                continue;
            }
            let is_bi = analysis.paths.copies[copy].path_type == PathType::BoundaryInside;
            if settings.response != Response::Contour && is_bi {
                self.push(view, copy);
            }
            // Also beside the push: on the few BI scenes tried, shortening alone never resolved, and both were somewhat
            // faster than the push alone.
            self.shorten(view, copy);
        }
        num_done
    }

    /// Pushes a BI path and its partner over the nearest boundaries, or a pair of paths round tubes over the nearer
    /// boundary of both: to slip one tube out of the other takes no strain, to turn it inside out does. False where no
    /// boundary is near or the directions to it cancel.
    fn push(&mut self, view: &AnalysedFrame<'_>, copy: usize) -> bool {
        let Self { boundary_push, steps, spread, forces, .. } = self;
        let AnalysedFrame { mesh, frame, settings, .. } = *view;
        let Some(PathOnFaces { points, segments, edge_length_m, is_closed: round, .. }) = PathOnFaces::of(view, copy)
        else {
            return false;
        };
        let path = PushedPath { mesh, frame, points, segments, settings, edge_length_m };
        let over_partner = boundary_push.steps(&path, Sheet::Partner, &mut steps[0]);
        let over_own = boundary_push.steps(&path, Sheet::Own, &mut steps[1]);
        if over_partner.is_none() && over_own.is_none() {
            return false;
        }
        let mut depths_m = [over_partner, over_own].map(|depth| depth.map_or(0.0, |depth| depth.greatest_m));
        if round && let (Some(partner), Some(own)) = (over_partner, over_own) {
            // Two tubes slip along each other: pushes over the boundary of each would be opposite and cancel.
            let left_out = usize::from(partner.mean_m <= own.mean_m);
            steps[left_out].fill(Vector3::zeros());
            depths_m[left_out] = 0.0;
        }
        let depth_m = depths_m[0].max(depths_m[1]);
        // On the path itself as far as its faces allow, the rest by the field round it.
        let near_m = ForceLaw::new(settings, edge_length_m, 0.0).largest_m;
        spread.reset(mesh.num_vertices());
        for (index, segment) in segments.iter().enumerate() {
            let (start, end) = (&points[index], &points[index + 1]);
            let own = MaterialPoint::middle(mesh, segment.own, [&start.own, &end.own]);
            let partner = MaterialPoint::middle(mesh, segment.partner, [&start.partner, &end.partner]);
            if let (Some(own), Some(partner)) = (own, partner) {
                // The path goes over the partner's boundary, the partner over that of the path.
                let step = steps[0][index] - steps[1][index];
                mesh.face(segment.own).into_iter().for_each(|vertex| spread.seed(vertex, step));
                mesh.face(segment.partner).into_iter().for_each(|vertex| spread.seed(vertex, -step));
                let force = limited(step, near_m) * (PUSH_WEIGHT * mass_at(mesh, &own));
                forces.add_pair(&own, &partner, force, near_m);
            }
        }
        let deep_m = ForceLaw::of_push(settings, edge_length_m, depth_m).largest_m;
        if settings.steps_to_clean.is_finite() {
            spread.add_to(mesh, frame, Field::of_tangle(depth_m, edge_length_m, deep_m), forces);
        }
        true
    }

    /// Adds the forces of contour minimisation for a path and its partner; none where the largest step has no limit.
    fn shorten(&mut self, view: &AnalysedFrame<'_>, copy: usize) {
        let AnalysedFrame { mesh, frame, settings, .. } = *view;
        let Some(path) = PathOnFaces::of(view, copy) else { return };
        // By the edges, however deep the tangle is: a field round a path without targets, tried on the scenes of
        // `host_table`, cleaned fewer of them.
        let largest_m = ForceLaw::new(settings, path.edge_length_m, 0.0).largest_m;
        if largest_m.is_infinite() {
            // The gradient has no size but the limit, and an infinite force would override all others on these
            // vertices.
            return;
        }
        // A path that is its own partner runs twice over every point of the world.
        let share = if path.is_own_partner { 0.5 } else { 1.0 };
        // One mass for all: only as a whole does the gradient keep momenta.
        let strength = -share * largest_m * mean_mass_kg(mesh, path.segments);
        length_gradient(mesh, frame, path.points, path.is_closed, GUARD, |vertex, gradient| {
            self.forces.add(vertex, gradient * strength, largest_m);
        });
    }
}

/// A path with what the forces without targets have to know of it.
struct PathOnFaces<'a> {
    points: &'a [PathPoint],
    segments: &'a [PathSegment],
    /// Mean edge length of the faces that it runs through.
    edge_length_m: f64,
    is_closed: bool,
    is_own_partner: bool,
}

impl<'a> PathOnFaces<'a> {
    /// A path; nothing where its faces have no edges.
    fn of(view: &AnalysedFrame<'a>, copy: usize) -> Option<Self> {
        let AnalysedFrame { mesh, frame, analysis, .. } = *view;
        let path = &analysis.paths.copies[copy];
        let points = &analysis.paths.points[path.points.clone()];
        let segments = &analysis.paths.segments[path.segments.clone()];
        Some(Self {
            points,
            segments,
            edge_length_m: mean_edge_length(mesh, frame, segments.iter().map(|segment| segment.own))?,
            is_closed: path.closed,
            is_own_partner: path.partner == copy,
        })
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

/// Adds forces between points inside and their targets, and between the sheets along the path.
fn attract(view: &AnalysedFrame<'_>, found: &Correspondences, path: &PathCorrespondence, forces: &mut Forces) {
    let attractions = &found.attractions[path.attractions.clone()];
    let offset =
        |attraction: &Attraction| attraction.target.position(view.frame) - attraction.source.position(view.frame);
    let depth_m = attractions.iter().map(|attraction| offset(attraction).norm()).fold(0.0, f64::max);
    let law = ForceLaw::new(view.settings, path.edge_length_m, depth_m);
    for attraction in attractions {
        let offset = offset(attraction);
        let distance = offset.norm();
        // A point in its own target has no direction; the separation constraints beside it have one.
        if distance > 1e-9 * path.edge_length_m {
            let size = mass_at(view.mesh, &attraction.source) * law.step(distance);
            forces.add_pair(&attraction.source, &attraction.target, offset * (size / distance), law.largest_m);
        }
    }
    for separation in &found.separations[path.separations.clone()] {
        let part = SEPARATION_WEIGHT * separation.length_m / path.edge_length_m;
        let size = mass_at(view.mesh, &separation.own) * law.step(0.0) * part;
        forces.add_pair(&separation.own, &separation.partner, separation.direction * size, law.largest_m);
    }
}

/// Mean mass of the vertices of the faces that a path runs through; 1 kg where the mesh has none.
fn mean_mass_kg(mesh: &Mesh, segments: &[PathSegment]) -> f64 {
    let faces = segments.iter().flat_map(|segment| [segment.own, segment.partner]);
    let sum: f64 = faces.flat_map(|face| mesh.face(face)).map(|vertex| mass_kg(mesh, vertex)).sum();
    #[expect(clippy::cast_precision_loss, reason = "a count of segments")]
    let mean = sum / (6 * segments.len()) as f64;
    mean
}
