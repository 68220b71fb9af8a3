//! The motion that draws the two sheets of a contour apart: its direction, its length, and where they meet on the way.

use nalgebra::Vector3;

use super::{
    contour::{Contour, ContourSegment},
    shadow::Shadow,
    windows::{MAX_FACES, Scene, Shortest, Windows},
};
use crate::{
    correspond::MaterialPoint,
    frame::Frame,
    mesh::{FaceId, Mesh, VertexId},
};

/// What a motion of the length of an edge, of a contour of the length of an edge, counts for beside an edge-face
/// intersection.
const WEIGHT: f64 = 0.05;
/// A contour is cut in halves where their motions together cost less than this part of its own, and it has so many
/// segments for each.
const SPLIT: f64 = 0.75;
const MIN_SEGMENTS: usize = 6;
/// How often halves are cut again where that saved nothing.
const MAX_FRUITLESS: usize = 2;
/// Motions shorter than this many mean edge lengths are not cut.
const MIN_SPLIT_DEPTH: f64 = 1.0;

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

/// Finds motions, reusing its memory.
#[derive(Debug, Default)]
pub(crate) struct MotionFinder {
    windows: Windows,
}

impl MotionFinder {
    /// Takes other ways out than the shortest, where the variant is not 0.
    pub(crate) fn of_variant(variant: usize) -> Self {
        Self { windows: Windows { variant, ..Windows::default() } }
    }

    /// The motions of a contour: one, or several where its pieces have shorter ways out.
    pub(crate) fn find(&mut self, scene: &Scene<'_>, contour: &Contour, motions: &mut Vec<Motion>) {
        self.windows.shadow.set_hinged(scene.mesh, scene.found);
        let shortest = self.windows.shortest(scene, contour, None);
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
            let shortest = [0, 1].map(|k| self.windows.shortest(scene, &halves[k], Some(whole.direction)));
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

    /// The motion with all points on its way.
    fn motion(&mut self, scene: &Scene<'_>, contour: &Contour, shortest: Shortest) -> Motion {
        let Scene { mesh, frame, .. } = *scene;
        self.windows.sheets.grow(mesh, frame, contour, shortest.radius_m, MAX_FACES);
        let mut motion = Motion {
            direction: shortest.direction,
            depth_m: shortest.depth_m,
            separations: Vec::new(),
            faces: self.windows.sheets.faces.clone(),
            first: contour.segments[0].faces[0],
            edge_length_m: contour.edge_length_m,
            length_m: contour.length_m(),
        };
        add_points_on_contour(mesh, contour, &mut motion.separations);
        self.add_vertices(mesh, frame, &mut motion);
        motion
    }

    /// Adds the vertices of both sheets that are behind the other one.
    fn add_vertices(&mut self, mesh: &Mesh, frame: &Frame, motion: &mut Motion) {
        let limit_m = motion.depth_m * (1.0 + 1e-9);
        for sheet in 0..2 {
            let faces = [&*self.windows.sheets.faces[sheet], &*self.windows.sheets.faces[1 - sheet]];
            let along = if sheet == 0 { motion.direction } else { -motion.direction };
            self.windows.shadow.look(mesh, frame.positions(), faces, along);
            for &vertex in &self.windows.sheets.vertices[sheet] {
                let Some(found) = self.windows.shadow.farthest_meeting(frame.position(vertex), vertex, limit_m) else {
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
