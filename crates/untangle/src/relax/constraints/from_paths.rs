//! The constraints of one iteration, path by path.

use nalgebra::Vector3;

use super::rows::Constraints;
use crate::{
    analysis::Analysis,
    correspond::{Correspondences, MaterialPoint, PathCorrespondence},
    frame::Frame,
    geometry::mean_edge_length,
    mesh::{FaceId, Mesh},
    paths::{PathCopy, PathPoint, PathType, SurfacePoint},
    respond::contour,
    sides::Orientation,
};

/// Gap that is to be left between the sheets, in mean edge lengths of the faces along the path.
const GAP: f64 = 0.5;
/// Part of its length that contour minimisation wants a path to lose in one iteration.
const SHORTENING: f64 = 0.6;

/// What constraints ask of the paths that have targets. The others get shorter, or slide out, with any objective.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Objective {
    /// Points inside cross the corresponding sheet at their targets, along its normal.
    Normal,
    /// Points inside move to their targets.
    Target,
    /// Paths get shorter.
    Shorten,
}

/// What the constraints of one frame are made from.
#[derive(Clone, Copy)]
pub(crate) struct ConstraintSource<'a> {
    pub(crate) mesh: &'a Mesh,
    pub(crate) frame: &'a Frame,
    pub(crate) analysis: &'a Analysis,
    pub(crate) found: &'a Correspondences,
    pub(crate) orientation: &'a Orientation,
}

/// Replaces `constraints` by those of all paths, but for paths that were left out when their targets were looked for.
pub(crate) fn collect(constraints: &mut Constraints, source: &ConstraintSource<'_>, objective: Objective) {
    collect_some(constraints, source, objective, |_| true);
}

/// As [`collect`], for paths between faces whose sides nothing else says: out of a body, and out from behind a layer,
/// leads the way to its surface.
pub(crate) fn collect_undecided(
    constraints: &mut Constraints,
    source: &ConstraintSource<'_>,
    objective: Objective,
    is_decided: impl Fn([FaceId; 2]) -> bool,
) {
    let Analysis { paths, .. } = source.analysis;
    collect_some(constraints, source, objective, |path| {
        let segments = &paths.segments[path.segments.clone()];
        !segments.iter().any(|segment| is_decided([segment.own, segment.partner]))
    });
}

fn collect_some(
    constraints: &mut Constraints,
    source: &ConstraintSource<'_>,
    objective: Objective,
    is_asked: impl Fn(&PathCopy) -> bool,
) {
    constraints.clear();
    let copies = &source.analysis.paths.copies;
    let mut is_left_out = vec![false; copies.len()];
    for &copy in &source.analysis.regions.order[source.found.num_done..] {
        is_left_out[copy] = true;
    }
    for (copy, path) in copies.iter().enumerate() {
        if is_left_out[copy] || !is_asked(path) {
            continue;
        }
        let has_targets = |copy: usize| source.found.paths.binary_search_by_key(&copy, |path| path.copy);
        match (objective, has_targets(copy)) {
            (Objective::Normal, _) if source.is_fold_of_one_ring(copy) => {
                source.draw_back(constraints, copy);
            }
            (Objective::Normal, Ok(index)) => source.separate(constraints, &source.found.paths[index], false),
            (Objective::Target, Ok(index)) => source.separate(constraints, &source.found.paths[index], true),
            (Objective::Normal | Objective::Target, Err(_)) if has_targets(path.partner).is_ok() => {}
            // A constraint on both paths of a pair is made once.
            _ if copy > path.partner => {}
            (Objective::Normal | Objective::Target, Err(_)) if path.path_type == PathType::BoundaryInside => {
                source.slide(constraints, copy);
            }
            _ => source.shorten(constraints, copy),
        }
    }
}

impl ConstraintSource<'_> {
    /// Separates the sheets along a path with a region: points inside move to the other side of the corresponding
    /// sheet.
    fn separate(&self, constraints: &mut Constraints, path: &PathCorrespondence, to_targets: bool) {
        let Self { mesh, frame, analysis, found, orientation } = *self;
        let gap = GAP * path.edge_length_m;
        let side = self.side_of_inside(path);
        // Where both sheets have an inside they change places; a single one goes to the other sheet.
        let partner = analysis.paths.copies[path.copy].partner;
        let both = found.paths.binary_search_by_key(&partner, |path| path.copy).is_ok();
        let num_shares = if both { 2.0 } else { 1.0 };
        for separation in &found.separations[path.separations.clone()] {
            constraints.separate(&separation.own, &separation.partner, separation.direction, gap);
        }
        for attraction in &found.attractions[path.attractions.clone()] {
            let to_target = attraction.target.position(frame) - attraction.source.position(frame);
            let Some(normal) = orientation.normal(mesh, frame, &attraction.target) else { continue };
            let (own, partner) = (&attraction.source, &attraction.target);
            if to_targets {
                let length = to_target.norm();
                if length > 1e-9 * path.edge_length_m {
                    constraints.separate(own, partner, to_target / length, num_shares * length + gap);
                }
            } else {
                let normal = normal * side;
                constraints.separate(own, partner, normal, normal.dot(&to_target) + gap);
            }
        }
    }

    /// The side of the corresponding sheet on which the inside of a path belongs: 1 along its normals, -1 against them.
    fn side_of_inside(&self, path: &PathCorrespondence) -> f64 {
        let mut side = 0.0;
        for separation in &self.found.separations[path.separations.clone()] {
            if let Some(normal) = self.orientation.normal(self.mesh, self.frame, &separation.partner) {
                side += separation.length_m * separation.direction.dot(&normal);
            }
        }
        if side < 0.0 { -1.0 } else { 1.0 }
    }

    /// Slides one sheet of a BI pair along the path over the boundary of the other.
    fn slide(&self, constraints: &mut Constraints, copy: usize) {
        let Self { mesh, frame, analysis, .. } = *self;
        let path = &analysis.paths.copies[copy];
        let points = &analysis.paths.points[path.points.clone()];
        let segments = &analysis.paths.segments[path.segments.clone()];
        let Some(edge_length_m) = mean_edge_length(mesh, frame, segments.iter().map(|segment| segment.own)) else {
            return;
        };
        let (Some(first), Some(last)) = (points.first(), points.last()) else { return };
        let ends_on_partner_boundary =
            |point: &PathPoint| matches!(point.partner, SurfacePoint::Edge { edge, .. } if mesh.is_boundary_edge(edge));
        let exit = if ends_on_partner_boundary(last) { last.position } else { first.position };
        for (index, segment) in segments.iter().enumerate() {
            let (start, end) = (&points[index], &points[index + 1]);
            let own = MaterialPoint::middle(mesh, segment.own, [&start.own, &end.own]);
            let partner = MaterialPoint::middle(mesh, segment.partner, [&start.partner, &end.partner]);
            let to_exit = exit - nalgebra::center(&start.position, &end.position);
            let length = to_exit.norm();
            if let (Some(own), Some(partner)) = (own, partner)
                && length > 0.0
            {
                constraints.separate(&own, &partner, to_exit / length, length + GAP * edge_length_m);
            }
        }
    }

    /// Makes a path shorter, down the gradient of its length (Volino and Magnenat-Thalmann 2006).
    fn shorten(&self, constraints: &mut Constraints, copy: usize) {
        let Self { mesh, frame, analysis, .. } = *self;
        let path = &analysis.paths.copies[copy];
        let points = &analysis.paths.points[path.points.clone()];
        let mut squared = 0.0;
        let mut descent = Vec::new();
        contour::length_gradient(mesh, frame, points, path.closed, contour::GUARD, |vertex, gradient| {
            descent.push((vertex, -gradient));
            squared += gradient.norm_squared();
        });
        let length: f64 = points.windows(2).map(|pair| (pair[1].position - pair[0].position).norm()).sum();
        let norm = squared.sqrt();
        if norm > 0.0 && length > 0.0 {
            let unit = descent.into_iter().map(|(vertex, direction): (_, Vector3<f64>)| (vertex, direction / norm));
            constraints.add(unit, SHORTENING * length / norm);
        } else {
            self.draw_back(constraints, copy);
        }
    }

    /// Whether a path is a segment between two faces round a loop vertex, there and back, with no vertex inside. It
    /// gets shorter only by crushing one of these faces, and its targets lie as near to the loop vertex as its points.
    fn is_fold_of_one_ring(&self, copy: usize) -> bool {
        let path = &self.analysis.paths.copies[copy];
        path.path_type == PathType::BoundaryLoopInside
            && path.segments.len() == 2
            && self.analysis.regions.vertices_of(copy).is_empty()
    }

    /// Draws edges back out of the faces that they pierce, by the end that is nearer: for paths that can't get shorter.
    fn draw_back(&self, constraints: &mut Constraints, copy: usize) {
        let Self { mesh, frame, analysis, .. } = *self;
        let path = &analysis.paths.copies[copy];
        let Some(edge_length_m) = mean_edge_length(
            mesh,
            frame,
            analysis.paths.segments[path.segments.clone()].iter().map(|segment| segment.own),
        ) else {
            return;
        };
        for point in &analysis.paths.points[path.points.clone()] {
            let ((SurfacePoint::Edge { edge, parameter }, SurfacePoint::Face { face, barycentric })
            | (SurfacePoint::Face { face, barycentric }, SurfacePoint::Edge { edge, parameter })) =
                (point.own, point.partner)
            else {
                continue;
            };
            let [a, b, c] = mesh.face(face).map(|vertex| frame.position(vertex));
            let Some(normal) = (b - a).cross(&(c - a)).try_normalize(0.0) else { continue };
            let ends = mesh.edge(edge);
            let (tip, other) = if parameter < 0.5 { (ends[0], ends[1]) } else { (ends[1], ends[0]) };
            let depth = normal.dot(&(frame.position(tip) - point.position));
            let back = normal.dot(&(frame.position(other) - point.position));
            let direction = if back - depth < 0.0 { -normal } else { normal };
            let pierced = MaterialPoint { vertices: mesh.face(face), weights: barycentric };
            let wanted_m = depth.abs() + GAP * edge_length_m;
            constraints.separate(&MaterialPoint::vertex(tip), &pierced, direction, wanted_m);
        }
    }
}
