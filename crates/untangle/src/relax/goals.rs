//! What an iteration wants: linear inequalities on the motion of the vertices, path by path.

use nalgebra::Vector3;

use super::orient::Orientation;
use crate::{
    analysis::Analysis,
    correspond::{Correspondences, MaterialPoint, PathCorrespondence},
    frame::Frame,
    geometry::mean_edge_length,
    mesh::{Mesh, VertexId},
    paths::{PathPoint, PathType, SurfacePoint},
    respond::contour,
};

/// Gap that is to be left between the sheets, in mean edge lengths of the faces along the path.
const GAP: f64 = 0.5;
/// Part of its length that contour minimisation wants a path to lose in one iteration.
const SHORTENING: f64 = 0.6;

/// `sum of coefficient . motion >= wanted_m`, one row for each goal.
#[derive(Debug, Default)]
pub(super) struct Goals {
    /// Where the terms of each goal end.
    ends: Vec<usize>,
    terms: Vec<(VertexId, Vector3<f64>)>,
    wanted_m: Vec<f64>,
    /// For each goal the copy of the path that it belongs to.
    copies: Vec<usize>,
    /// For each goal whether it is a distance between two points.
    is_pair: Vec<bool>,
    /// For each copy of a path whether time did not suffice for it.
    is_left_out: Vec<bool>,
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
        let start = if goal == 0 { 0 } else { self.ends[goal - 1] };
        &self.terms[start..self.ends[goal]]
    }

    pub(super) fn wanted_m(&self, goal: usize) -> f64 {
        self.wanted_m[goal]
    }

    /// All vertices that goals speak of, some of them several times.
    pub(super) fn vertices(&self) -> impl Iterator<Item = VertexId> + '_ {
        self.terms.iter().map(|&(vertex, _)| vertex)
    }

    /// Forgets all goals.
    pub(super) fn clear(&mut self) {
        self.ends.clear();
        self.terms.clear();
        self.wanted_m.clear();
        self.copies.clear();
        self.is_pair.clear();
    }

    /// Collects the goals of all paths, but for those that were left out when their targets were looked for.
    pub(super) fn collect(&mut self, scene: &Scene<'_>, aim: Aim) {
        self.clear();
        let copies = &scene.analysis.paths.copies;
        self.is_left_out.clear();
        self.is_left_out.resize(copies.len(), false);
        for &copy in &scene.analysis.regions.order[scene.found.num_done..] {
            self.is_left_out[copy] = true;
        }
        for (copy, path) in copies.iter().enumerate() {
            if self.is_left_out[copy] {
                continue;
            }
            let has = |copy: usize| scene.found.paths.binary_search_by_key(&copy, |path| path.copy);
            match (aim, has(copy)) {
                (Aim::Normal, Ok(index)) => self.part(scene, &scene.found.paths[index], false),
                (Aim::Target, Ok(index)) => self.part(scene, &scene.found.paths[index], true),
                (Aim::Normal | Aim::Target, Err(_)) if has(path.partner).is_ok() => {}
                // What concerns both paths of a pair is said once.
                _ if copy > path.partner => {}
                (Aim::Normal | Aim::Target, Err(_)) if path.path_type == PathType::BoundaryInside => {
                    self.slide(scene, copy);
                }
                _ => self.shorten(scene, copy),
            }
        }
    }

    /// Parts the sheets along a path with a region: points inside move to the other side of the corresponding sheet.
    fn part(&mut self, scene: &Scene<'_>, path: &PathCorrespondence, to_targets: bool) {
        let Scene { mesh, frame, analysis, found, orientation } = *scene;
        let gap = GAP * path.edge_length_m;
        let separations = &found.separations[path.separations.clone()];
        // The side of the corresponding sheet on which the inside belongs.
        let mut side = 0.0;
        for separation in separations {
            if let Some(normal) = orientation.normal(mesh, frame, &separation.partner) {
                side += separation.length_m * separation.direction.dot(&normal);
            }
        }
        let side = if side < 0.0 { -1.0 } else { 1.0 };
        // Where both sheets have an inside they change places; a single one goes to the other sheet.
        let partner = analysis.paths.copies[path.copy].partner;
        let both = found.paths.binary_search_by_key(&partner, |path| path.copy).is_ok();
        let way_parts = if both { 2.0 } else { 1.0 };
        for separation in separations {
            self.push_pair(&separation.own, &separation.partner, separation.direction, gap, path.copy);
        }
        for attraction in &found.attractions[path.attractions.clone()] {
            let way = attraction.target.position(frame) - attraction.source.position(frame);
            let Some(normal) = orientation.normal(mesh, frame, &attraction.target) else { continue };
            let normal = normal * side;
            if to_targets {
                let length = way.norm();
                if length > 1e-9 * path.edge_length_m {
                    self.push_pair(
                        &attraction.source,
                        &attraction.target,
                        way / length,
                        way_parts * length + gap,
                        path.copy,
                    );
                }
            } else {
                self.push_pair(&attraction.source, &attraction.target, normal, normal.dot(&way) + gap, path.copy);
            }
        }
    }

    /// Slides one sheet of a BI pair along the path over the boundary of the other.
    fn slide(&mut self, scene: &Scene<'_>, copy: usize) {
        let Scene { mesh, frame, analysis, .. } = *scene;
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
            let way = exit - nalgebra::center(&start.position, &end.position);
            let length = way.norm();
            if let (Some(own), Some(partner)) = (own, partner)
                && length > 0.0
            {
                self.push_pair(&own, &partner, way / length, length + GAP * edge_length_m, copy);
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
            self.finish_row(SHORTENING * length / norm, copy, false);
        } else {
            self.terms.truncate(first);
            self.draw_back(scene, copy);
        }
    }

    /// Draws edges back out of the faces that they pierce, by the end that is nearer: for paths that are mere points.
    fn draw_back(&mut self, scene: &Scene<'_>, copy: usize) {
        let Scene { mesh, frame, analysis, .. } = *scene;
        let path = &analysis.paths.copies[copy];
        let faces = analysis.paths.segments[path.segments.clone()].iter().map(|segment| segment.own);
        let Some(edge_length_m) = mean_edge_length(mesh, frame, faces) else { return };
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
            self.push_pair(&MaterialPoint::vertex(tip), &pierced, direction, wanted_m, copy);
        }
    }

    /// Wants two points that are apart to stay apart.
    pub(super) fn keep_apart(&mut self, frame: &Frame, own: &MaterialPoint, partner: &MaterialPoint, gap_m: f64) {
        let apart = own.position(frame) - partner.position(frame);
        let length = apart.norm();
        if length > 0.0 {
            self.push_pair(own, partner, apart / length, gap_m.min(0.5 * length) - length, usize::MAX);
        }
    }

    /// Takes over goals of another frame, to be held from now on: what they have parted stays apart.
    pub(super) fn hold(&mut self, other: &Self, frame: &Frame) {
        for goal in 0..other.len() {
            let apart: f64 = other
                .row(goal)
                .iter()
                .map(|(vertex, coefficient)| coefficient.dot(&frame.position(*vertex).coords))
                .sum();
            // Only pairs of points part; a path that is to get shorter is no distance.
            if other.is_pair[goal] && apart > 0.0 {
                self.terms.extend_from_slice(other.row(goal));
                self.finish_row(0.0, other.copies[goal], true);
            }
        }
    }

    /// Wants of all goals that they stay as far apart as they are now, but no farther than `gap_m`.
    pub(super) fn stay_apart(&mut self, frame: &Frame, gap_m: f64) {
        for goal in 0..self.len() {
            let apart: f64 = self
                .row(goal)
                .iter()
                .map(|(vertex, coefficient)| coefficient.dot(&frame.position(*vertex).coords))
                .sum();
            self.wanted_m[goal] = apart.min(gap_m) - apart;
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
        self.finish_row(wanted_m, copy, true);
    }

    fn finish_row(&mut self, wanted_m: f64, copy: usize, is_pair: bool) {
        self.is_pair.push(is_pair);
        self.ends.push(self.terms.len());
        self.wanted_m.push(wanted_m);
        self.copies.push(copy);
    }
}
