//! What an iteration wants: linear inequalities on the motion of the vertices, path by path.

use nalgebra::Vector3;

use super::{domain::Domain, orient::Orientation};
use crate::{
    analysis::Analysis,
    correspond::{Correspondences, MaterialPoint, PathCorrespondence, mean_edge_length},
    frame::Frame,
    mesh::{Mesh, VertexId},
    paths::{PathPoint, PathType, SurfacePoint},
    respond::contour,
};

/// Gap that is to be left between the sheets, in mean edge lengths of the faces along the path.
fn gap_edges() -> f64 {
    super::knob("GAP", 0.5)
}
/// Part of its length that contour minimisation wants a path to lose in one iteration.
const SHORTENING: f64 = 0.6;

/// `sum of coefficient . motion >= wanted_m`, one row for each goal.
#[derive(Debug, Default)]
pub(super) struct Goals {
    offsets: Vec<usize>,
    terms: Vec<(VertexId, Vector3<f64>)>,
    wanted_m: Vec<f64>,
    /// For each goal the copy of the path that it belongs to.
    copies: Vec<usize>,
}

/// How goals are found for the paths that have targets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Aim {
    /// Points inside go beyond the surface at their targets, along its normal.
    Normal,
    /// Points inside go to their targets.
    Target,
    /// Paths get shorter.
    Shorten,
}

/// What the goals of one frame are made from.
#[derive(Clone, Copy)]
pub(super) struct Scene<'a> {
    pub(super) mesh: &'a Mesh,
    pub(super) frame: &'a Frame,
    pub(super) analysis: &'a Analysis,
    pub(super) found: &'a Correspondences,
    pub(super) orientation: &'a Orientation,
}

impl Goals {
    pub(super) fn len(&self) -> usize {
        self.wanted_m.len()
    }

    pub(super) fn row(&self, goal: usize) -> &[(VertexId, Vector3<f64>)] {
        &self.terms[self.offsets[goal]..self.offsets[goal + 1]]
    }

    pub(super) fn wanted_m(&self, goal: usize) -> f64 {
        self.wanted_m[goal]
    }

    pub(super) fn copy(&self, goal: usize) -> usize {
        self.copies[goal]
    }

    /// All vertices that goals speak of, some of them several times.
    pub(super) fn vertices(&self) -> impl Iterator<Item = VertexId> + '_ {
        self.terms.iter().map(|&(vertex, _)| vertex)
    }

    /// Collects the goals of all paths; `aim` says for each copy how.
    pub(super) fn collect(&mut self, scene: &Scene<'_>, aim: impl Fn(usize) -> Aim) {
        self.offsets.clear();
        self.offsets.push(0);
        self.terms.clear();
        self.wanted_m.clear();
        self.copies.clear();
        let copies = &scene.analysis.paths.copies;
        for (copy, path) in copies.iter().enumerate() {
            let has = |copy: usize| scene.found.paths.binary_search_by_key(&copy, |path| path.copy);
            match (aim(copy), has(copy)) {
                (Aim::Normal, Ok(index)) => self.part(scene, &scene.found.paths[index], false),
                (Aim::Target, Ok(index)) => self.part(scene, &scene.found.paths[index], true),
                (Aim::Normal | Aim::Target, Err(_)) if has(path.partner).is_ok() => {}
                (Aim::Normal | Aim::Target, Err(_)) if path.path_type == PathType::BoundaryInside => {
                    if copy < path.partner {
                        self.slide(scene, copy);
                    }
                }
                _ if copy <= path.partner => self.shorten(scene, copy),
                _ => {}
            }
        }
    }

    /// Parts the sheets along a path with a region: points inside move to the other side of the corresponding sheet.
    fn part(&mut self, scene: &Scene<'_>, path: &PathCorrespondence, to_targets: bool) {
        let Scene { mesh, frame, found, orientation, .. } = *scene;
        let gap = gap_edges() * path.edge_length_m;
        let partings = &found.partings[path.partings.clone()];
        // The side of the corresponding sheet on which the inside belongs.
        let mut side = 0.0;
        for parting in partings {
            if let Some(normal) = orientation.normal(mesh, frame, &parting.partner) {
                side += parting.length_m * parting.direction.dot(&normal);
            }
        }
        let side = if side < 0.0 { -1.0 } else { 1.0 };
        for parting in partings {
            self.push_pair(&parting.own, &parting.partner, parting.direction, gap, path.copy);
        }
        for pull in &found.pulls[path.pulls.clone()] {
            let way = pull.target.position(frame) - pull.source.position(frame);
            let Some(normal) = orientation.normal(mesh, frame, &pull.target) else { continue };
            let normal = normal * side;
            if to_targets {
                let length = way.norm();
                if length > 1e-9 * path.edge_length_m {
                    self.push_pair(&pull.source, &pull.target, way / length, length + gap, path.copy);
                }
            } else {
                self.push_pair(&pull.source, &pull.target, normal, normal.dot(&way) + gap, path.copy);
            }
        }
    }

    /// Slides one sheet of a BI pair along the path over the boundary of the other.
    fn slide(&mut self, scene: &Scene<'_>, copy: usize) {
        let Scene { mesh, frame, analysis, .. } = *scene;
        let path = &analysis.paths.copies[copy];
        let points = &analysis.paths.points[path.points.clone()];
        let segments = &analysis.paths.segments[path.segments.clone()];
        let Some(edge_length_m) = mean_edge_length(mesh, frame, segments) else { return };
        let (Some(first), Some(last)) = (points.first(), points.last()) else { return };
        let ends_on_partner_boundary =
            |point: &PathPoint| matches!(point.partner, SurfacePoint::Edge { edge, .. } if mesh.is_boundary_edge(edge));
        let exit = if ends_on_partner_boundary(last) { last.position } else { first.position };
        for (index, segment) in segments.iter().enumerate() {
            let (start, end) = (&points[index], &points[index + 1]);
            let own = MaterialPoint::middle(mesh, segment.own, [&start.own, &end.own]);
            let partner = MaterialPoint::middle(mesh, segment.partner, [&start.partner, &end.partner]);
            let way = exit - nalgebra::center(&start.position, &end.position);
            let length = way.norm();
            if let (Some(own), Some(partner)) = (own, partner)
                && length > 0.0
            {
                self.push_pair(&own, &partner, way / length, length + gap_edges() * edge_length_m, copy);
            }
        }
    }

    /// Wants a path to get shorter.
    fn shorten(&mut self, scene: &Scene<'_>, copy: usize) {
        let Scene { mesh, frame, analysis, .. } = *scene;
        let path = &analysis.paths.copies[copy];
        let points = &analysis.paths.points[path.points.clone()];
        let mut squared = 0.0;
        let first = self.terms.len();
        contour::length_gradient(mesh, frame, points, path.closed, contour::GUARD, |vertex, gradient| {
            self.terms.push((vertex, -gradient));
            squared += gradient.norm_squared();
        });
        let length: f64 = points.windows(2).map(|pair| (pair[1].position - pair[0].position).norm()).sum();
        let norm = squared.sqrt();
        if norm > 0.0 && length > 0.0 {
            for (_, coefficient) in &mut self.terms[first..] {
                *coefficient /= norm;
            }
            self.finish_row(SHORTENING * length / norm, copy);
        } else {
            self.terms.truncate(first);
        }
    }

    fn push_pair(
        &mut self,
        own: &MaterialPoint,
        partner: &MaterialPoint,
        direction: Vector3<f64>,
        wanted_m: f64,
        copy: usize,
    ) {
        for (point, sign) in [(own, 1.0), (partner, -1.0)] {
            for (&vertex, weight) in point.vertices.iter().zip(point.weights).filter(|(_, weight)| *weight != 0.0) {
                self.terms.push((vertex, direction * (sign * weight)));
            }
        }
        self.finish_row(wanted_m, copy);
    }

    fn finish_row(&mut self, wanted_m: f64, copy: usize) {
        self.offsets.push(self.terms.len());
        self.wanted_m.push(wanted_m);
        self.copies.push(copy);
    }

    /// Left-hand sides for a motion of the domain.
    pub(super) fn apply(&self, domain: &Domain, motion: &[Vector3<f64>], out: &mut Vec<f64>) {
        out.clear();
        out.extend((0..self.len()).map(|goal| {
            self.row(goal)
                .iter()
                .filter_map(|(vertex, coefficient)| domain.local(*vertex).map(|local| coefficient.dot(&motion[local])))
                .sum::<f64>()
        }));
    }
}
