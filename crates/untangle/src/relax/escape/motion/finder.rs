//! The motion that draws the two sheets of a contour apart: its direction, its length, and where they meet on the way.

use nalgebra::Vector3;

use super::{
    contour::{Contour, ContourSegment},
    directions::directions,
    shadow::Shadow,
    sheets::Sheets,
};
use crate::{
    correspond::MaterialPoint,
    frame::Frame,
    intersect::Intersections,
    mesh::{FaceId, Mesh, VertexId},
    sides::Orientation,
};

/// The first radius of the windows round a contour, in mean edge lengths, and its growth.
const FIRST_RADIUS: f64 = 4.0;
const RADIUS_GROWTH: f64 = 2.0;
const MAX_GROWTHS: usize = 5;
/// Windows end at so many faces.
const MAX_FACES: usize = 4000;
/// What overlaps is seen whole where the sheets are apart after this part of the radius.
const WHOLE: f64 = 0.6;

/// What a motion of the length of an edge, of a contour of the length of an edge, counts for beside an edge-face
/// intersection.
const WEIGHT: f64 = 0.05;
/// A contour is cut in halves where their motions together cost less than this part of its own, and it has so many
/// segments for each.
const SPLIT: f64 = 0.75;
const MIN_SEGMENTS: usize = 6;
/// How often halves are cut again where that saved nothing.
const MAX_FRUITLESS: usize = 2;
/// Directions with a lower cosine are different ways out.
const DIFFERENT: f64 = 0.7;
/// Motions shorter than this many mean edge lengths are not cut.
const MIN_SPLIT_DEPTH: f64 = 1.0;
/// A half keeps the direction of its whole unless another is shorter than this part of it.
const KEEP: f64 = 0.8;

/// A pair of points that has to move apart.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Separation {
    pub(crate) own: MaterialPoint,
    pub(crate) partner: MaterialPoint,
    /// By how much the first point is behind the second one, in metres.
    pub(crate) behind_m: f64,
}

/// How the first sheet of a contour leaves the second.
#[derive(Clone, Debug)]
pub(crate) struct Motion {
    /// Unit direction in which the first sheet moves, against the second.
    pub(crate) direction: Vector3<f64>,
    /// How far it has to move, in metres.
    pub(crate) depth_m: f64,
    /// Points on the way.
    pub(crate) separations: Vec<Separation>,
    /// The windows that were looked at.
    pub(crate) faces: [Vec<FaceId>; 2],
    /// A face along the contour.
    pub(crate) first: FaceId,
    pub(crate) edge_length_m: f64,
    pub(crate) length_m: f64,
}

impl Motion {
    /// The vertices of all its points, some of them several times.
    pub(crate) fn vertices(&self) -> impl Iterator<Item = VertexId> + '_ {
        self.separations.iter().flat_map(|separation| [separation.own, separation.partner]).flat_map(|at| at.vertices)
    }

    /// What its depth counts for.
    pub(crate) fn weight(&self) -> f64 {
        WEIGHT * (self.length_m / self.edge_length_m).max(1.0)
    }
}

/// The shortest motion of those looked at.
#[derive(Clone, Copy, Debug)]
struct Shortest {
    direction: Vector3<f64>,
    depth_m: f64,
    /// The radius of the windows that were looked at.
    radius_m: f64,
}

/// Finds motions, reusing its memory.
#[derive(Debug, Default)]
pub(crate) struct MotionFinder {
    /// Which of the ways that are about as short is taken.
    variant: usize,
    sheets: Sheets,
    shadow: Shadow,
}

/// What motions are found for.
#[derive(Clone, Copy)]
pub(crate) struct Scene<'a> {
    pub(crate) mesh: &'a Mesh,
    pub(crate) frame: &'a Frame,
    pub(crate) orientation: &'a Orientation,
    pub(crate) found: &'a Intersections,
}

impl MotionFinder {
    /// Takes other ways out than the shortest, where the variant is not 0.
    pub(crate) fn of_variant(variant: usize) -> Self {
        Self { variant, ..Self::default() }
    }

    /// The motions of a contour: one, or several where its pieces have shorter ways out.
    pub(crate) fn find(&mut self, scene: &Scene<'_>, contour: &Contour, motions: &mut Vec<Motion>) {
        self.shadow.set_hinged(scene.mesh, scene.found);
        let shortest = self.shortest(scene, contour, None);
        let mut pieces = Vec::new();
        self.refine(scene, contour.clone(), shortest, 0, &mut pieces);
        for (contour, shortest) in &pieces {
            motions.push(self.motion(scene, contour, *shortest));
        }
    }

    /// The motions of the pieces of a contour that cost least, with their cost: depths times lengths. Halves have to
    /// save some of the cost of their whole.
    fn refine(
        &mut self,
        scene: &Scene<'_>,
        contour: Contour,
        whole: Shortest,
        fruitless: usize,
        pieces: &mut Vec<(Contour, Shortest)>,
    ) -> f64 {
        let cost = whole.depth_m * contour.length_m();
        if fruitless < MAX_FRUITLESS
            && whole.depth_m > MIN_SPLIT_DEPTH * contour.edge_length_m
            && contour.length_m() > 2.0 * whole.depth_m
            && let Some(halves) = contour.halves(scene.mesh, scene.frame, MIN_SEGMENTS)
        {
            let shortest = [0, 1].map(|k| self.shortest(scene, &halves[k], Some(whole.direction)));
            let direct: f64 = shortest.iter().zip(&halves).map(|(part, half)| part.depth_m * half.length_m()).sum();
            let fruitless = if direct < SPLIT * cost { 0 } else { fruitless + 1 };
            let start = pieces.len();
            let mut parts = 0.0;
            for (half, shortest) in halves.into_iter().zip(shortest) {
                parts += self.refine(scene, half, shortest, fruitless, pieces);
            }
            if parts < SPLIT * cost {
                return parts;
            }
            pieces.truncate(start);
        }
        pieces.push((contour, whole));
        cost
    }

    /// The shortest motion of a contour. The windows round it grow until they see all that overlaps. A direction that
    /// is given is kept where others are hardly better.
    fn shortest(&mut self, scene: &Scene<'_>, contour: &Contour, kept: Option<Vector3<f64>>) -> Shortest {
        let Scene { mesh, frame, orientation, .. } = *scene;
        let mut candidates: Vec<(f64, Vector3<f64>)> = kept.iter().map(|&direction| (0.0, direction)).collect();
        candidates.extend(
            directions(mesh, frame, orientation, contour, kept.is_none()).into_iter().map(|direction| (0.0, direction)),
        );
        let mut radius_m = FIRST_RADIUS * contour.edge_length_m;
        for growth in 0..=MAX_GROWTHS {
            let is_complete = self.sheets.grow(mesh, frame, contour, radius_m, MAX_FACES);
            // A wider window can only add to a depth: what was deeper than the least so far needs no second look.
            let mut least = f64::INFINITY;
            for (depth, direction) in &mut candidates {
                let is_kept = kept.is_some_and(|kept| kept == *direction);
                if *depth < least || is_kept {
                    *depth = self.depth_m(mesh, frame, *direction, if is_kept { f64::INFINITY } else { least });
                    least = least.min(*depth);
                }
            }
            candidates.sort_by(|a, b| a.0.total_cmp(&b.0));
            if least <= WHOLE * radius_m || !is_complete || growth == MAX_GROWTHS {
                break;
            }
            radius_m *= RADIUS_GROWTH;
        }
        let (least, mut direction) = candidates[0];
        let mut depth_m = least;
        // Where the shortest way has not helped, others that are about as short may.
        if let Some((depth, other)) = self.other_way(&candidates, contour) {
            return Shortest { direction: other, depth_m: depth, radius_m };
        }
        if let Some(found) = candidates.iter().find(|found| kept == Some(found.1) && KEEP * found.0 <= least) {
            (depth_m, direction) = *found;
        }
        Shortest { direction, depth_m, radius_m }
    }

    /// A direction other than the shortest, for shallow contours that have not moved.
    fn other_way(&self, candidates: &[(f64, Vector3<f64>)], contour: &Contour) -> Option<(f64, Vector3<f64>)> {
        let limit = candidates[0].0 * 3.0 + contour.edge_length_m;
        let mut found: Vec<(f64, Vector3<f64>)> = Vec::new();
        for &(depth, direction) in candidates.iter().filter(|(depth, _)| *depth <= limit) {
            if found.iter().all(|(_, other)| other.dot(&direction) < DIFFERENT) {
                found.push((depth, direction));
            }
        }
        (self.variant > 0 && found.len() > 1).then(|| found[self.variant % found.len()])
    }

    /// The motion with all points on its way.
    fn motion(&mut self, scene: &Scene<'_>, contour: &Contour, shortest: Shortest) -> Motion {
        let Scene { mesh, frame, .. } = *scene;
        self.sheets.grow(mesh, frame, contour, shortest.radius_m, MAX_FACES);
        let mut motion = Motion {
            direction: shortest.direction,
            depth_m: shortest.depth_m,
            separations: Vec::new(),
            faces: self.sheets.faces.clone(),
            first: contour.segments[0].faces[0],
            edge_length_m: contour.edge_length_m,
            length_m: contour.length_m(),
        };
        add_points_on_contour(mesh, contour, &mut motion.separations);
        self.add_vertices(mesh, frame, &mut motion);
        motion
    }

    fn depth_m(&mut self, mesh: &Mesh, frame: &Frame, direction: Vector3<f64>, limit_m: f64) -> f64 {
        let [first, second] = &self.sheets.faces;
        self.shadow.look(mesh, frame.positions(), [first, second], direction);
        self.shadow.depth_m(limit_m)
    }

    /// Adds the vertices of both sheets that are behind the other one.
    fn add_vertices(&mut self, mesh: &Mesh, frame: &Frame, motion: &mut Motion) {
        let limit_m = motion.depth_m * (1.0 + 1e-9);
        for sheet in 0..2 {
            let faces = [&*self.sheets.faces[sheet], &*self.sheets.faces[1 - sheet]];
            let along = if sheet == 0 { motion.direction } else { -motion.direction };
            self.shadow.look(mesh, frame.positions(), faces, along);
            for &vertex in &self.sheets.vertices[sheet] {
                let Some(found) = self.shadow.farthest_meeting(frame.position(vertex), vertex, limit_m) else {
                    continue;
                };
                let ends =
                    [MaterialPoint::vertex(vertex), MaterialPoint { vertices: found.corners, weights: found.weights }];
                let (own, partner) = (ends[sheet], ends[1 - sheet]);
                motion.separations.push(Separation { own, partner, behind_m: found.shift_m });
            }
        }
    }
}

/// Adds the middles of the segments, where the sheets touch.
fn add_points_on_contour(mesh: &Mesh, contour: &Contour, separations: &mut Vec<Separation>) {
    for ContourSegment { faces, ends } in &contour.segments {
        let own = MaterialPoint::middle(mesh, faces[0], [&ends[0].own, &ends[1].own]);
        let partner = MaterialPoint::middle(mesh, faces[1], [&ends[0].partner, &ends[1].partner]);
        if let (Some(own), Some(partner)) = (own, partner) {
            separations.push(Separation { own, partner, behind_m: 0.0 });
        }
    }
}

/// How far the first sheet of a motion still has to move in another state, in metres.
pub(crate) fn remaining_depth_m(shadow: &mut Shadow, mesh: &Mesh, frame: &Frame, motion: &Motion) -> f64 {
    let [first, second] = &motion.faces;
    shadow.look(mesh, frame.positions(), [first, second], motion.direction);
    shadow.depth_m(f64::INFINITY)
}
