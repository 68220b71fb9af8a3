//! Unfolding: the shapes of a patch developed into the plane, face against face, along the path first, then outwards.
//!
//! A breadth-first spanning tree of the faces is unfolded: each face is placed beside its parent by the similarity of
//! the plane that makes their common edge agree and leaves them on different sides of it. One rule covers every source
//! of shapes: texture coordinates without a seam are reproduced, across a seam or a period they go on (also into a
//! panel that is mirrored or scaled), and lengths give the isometric unfolding.

#[cfg(test)]
mod tests;

use std::collections::VecDeque;

use nalgebra::Point2;

use super::{
    patch::{Neighbour, Patch},
    shapes::{Shape, sides_of},
};
use crate::geometry::{complex_quotient, left_normal, perimeter};

/// Where the vertices and faces of a patch lie in the plane.
#[derive(Debug, Default)]
pub(super) struct Unfolding {
    /// Place of each vertex of the patch; meaningless where no face of it was reached.
    pub(super) points: Vec<Point2<f64>>,
    /// For each face of the patch, whether it was reached and lies as its shape does, or mirrored.
    pub(super) facing: Vec<Facing>,
    /// Largest difference of a side of a face from that of its shape, as a part of the longest side of the face.
    pub(super) misfit: f64,
    /// For each face, which of its sides are edges of the spanning tree of faces.
    pub(super) tree: Vec<[bool; 3]>,
    /// For each face that was reached, which of its sides have no other face of the patch beyond them.
    pub(super) outline: Vec<[bool; 3]>,
    /// Sum of all sides of the faces that were reached, as they lie.
    pub(super) length: f64,
    /// For each face, which of its sides were looked at from beyond.
    seen: Vec<[bool; 3]>,
    /// The faces after the first in the order in which they were reached: from which one, across which side.
    reached_from: Vec<(usize, usize, usize)>,
    placed: Vec<bool>,
    /// Faces of the path go first, so that the path is unfolded along itself.
    path_queue: VecDeque<usize>,
    queue: VecDeque<usize>,
}

/// How a face lies in the plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Facing {
    /// Not connected to the first face by edges of the patch.
    Unreached,
    /// As its shape.
    Straight,
    /// As the mirror image of its shape.
    Mirrored,
}

impl Unfolding {
    /// Unfolds a patch from its first face. False where the patch is empty or one-sided (no orientation fits, and no
    /// chart exists), or a place is not finite.
    ///
    /// Cost: linear in the faces.
    pub(super) fn unfold(&mut self, patch: &Patch, shapes: &[Shape]) -> bool {
        self.reset(patch);
        let Some(corners) = patch.corners().first() else { return false };
        for (&vertex, &point) in corners.iter().zip(&shapes[0]) {
            self.points[vertex as usize] = point;
            self.placed[vertex as usize] = true;
        }
        self.facing[0] = Facing::Straight;
        self.path_queue.push_back(0);
        let mut is_orientable = true;
        while let Some(face) = self.path_queue.pop_front().or_else(|| self.queue.pop_front()) {
            for side in 0..3 {
                if !self.seen[face][side] {
                    is_orientable &= self.cross(patch, shapes, face, side);
                }
            }
        }
        self.measure_misfit(patch, shapes);
        is_orientable && self.points.iter().all(|point| point.x.is_finite() && point.y.is_finite())
    }

    /// Takes the place of each vertex from a smooth chart, which any unfolding gives back, and finds what edges connect
    /// with the first face.
    ///
    /// Cost: linear in the faces.
    pub(super) fn take(&mut self, patch: &Patch, places: &[Point2<f64>]) {
        self.reset(patch);
        self.points.copy_from_slice(places);
        let Some(first) = self.facing.first_mut() else { return };
        *first = Facing::Straight;
        self.queue.push_back(0);
        while let Some(face) = self.queue.pop_front() {
            self.length += perimeter(patch.corners()[face].map(|corner| places[corner as usize]));
            for side in 0..3 {
                let Some(Neighbour { face: next, .. }) = patch.neighbour(face, side) else {
                    self.outline[face][side] = true;
                    continue;
                };
                if self.facing[next] == Facing::Unreached {
                    self.facing[next] = Facing::Straight;
                    self.queue.push_back(next);
                }
            }
        }
    }

    fn reset(&mut self, patch: &Patch) {
        let (num_faces, num_vertices) = (patch.faces().len(), patch.vertices().len());
        self.points.clear();
        self.points.resize(num_vertices, Point2::origin());
        self.placed.clear();
        self.placed.resize(num_vertices, false);
        self.tree.clear();
        self.tree.resize(num_faces, [false; 3]);
        self.outline.clear();
        self.outline.resize(num_faces, [false; 3]);
        self.seen.clear();
        self.seen.resize(num_faces, [false; 3]);
        self.facing.clear();
        self.facing.resize(num_faces, Facing::Unreached);
        self.reached_from.clear();
        (self.misfit, self.length) = (0.0, 0.0);
        self.path_queue.clear();
        self.queue.clear();
    }

    /// Goes across a side of a face: places and queues the neighbour if it is new. False where it lies in the wrong
    /// orientation.
    fn cross(&mut self, patch: &Patch, shapes: &[Shape], face: usize, side: usize) -> bool {
        let Some(neighbour) = patch.neighbour(face, side) else {
            self.outline[face][side] = true;
            return true;
        };
        let Neighbour { face: next, side: there, is_same_way } = neighbour;
        self.seen[next][there] = true;
        let facing = facing_beside(self.facing[face], is_same_way, shapes, face, next);
        if self.facing[next] != Facing::Unreached {
            return self.facing[next] == facing;
        }
        self.facing[next] = facing;
        self.tree[face][side] = true;
        self.tree[next][there] = true;
        self.place(patch, shapes, [face, side], neighbour);
        self.reached_from.push((next, face, side));
        let queue = if next < patch.num_seeds() { &mut self.path_queue } else { &mut self.queue };
        queue.push_back(next);
        true
    }

    /// Writes for each face the scale of its shape in the chart: 1 for the first, equal lengths along common edges.
    pub(super) fn scales(&self, patch: &Patch, shapes: &[Shape], scales: &mut Vec<f64>) {
        scales.clear();
        scales.resize(shapes.len(), 1.0);
        for &(next, face, side) in &self.reached_from {
            scales[next] = scales[face] * ratio_of_sides(patch, shapes, face, side, next);
        }
    }

    /// Sums up [`length`](Self::length) again, after points were moved.
    pub(super) fn measure_length(&mut self, patch: &Patch) {
        let reached = patch.corners().iter().enumerate().filter(|&(face, _)| self.is_reached(face));
        self.length = reached
            .fold(0.0, |length, (_, corners)| length + perimeter(corners.map(|corner| self.points[corner as usize])));
    }

    /// Whether a face has a place.
    pub(super) fn is_reached(&self, face: usize) -> bool {
        self.facing[face] != Facing::Unreached
    }

    /// Places the third vertex of the neighbour across a side of a face, unless it has a place.
    fn place(&mut self, patch: &Patch, shapes: &[Shape], [face, side]: [usize; 2], neighbour: Neighbour) {
        let corners = patch.corners()[face];
        let (a, b) = (corners[side], corners[(side + 1) % 3]);
        let Neighbour { face: next, side: there, is_same_way } = neighbour;
        let ends = [there, (there + 1) % 3];
        let [at_a, at_b] = if is_same_way { ends } else { [ends[1], ends[0]] };
        let at_c = (there + 2) % 3;
        let c = patch.corners()[next][at_c] as usize;
        if self.placed[c] {
            return;
        }
        self.placed[c] = true;
        let shape = &shapes[next];
        let ratio = complex_quotient(shape[at_c] - shape[at_a], shape[at_b] - shape[at_a]);
        let (from, to) = (self.points[a as usize], self.points[b as usize]);
        let edge = to - from;
        let behind = edge.perp(&(self.points[corners[(side + 2) % 3] as usize] - from));
        let height = if behind > 0.0 { -ratio.y.abs() } else { ratio.y.abs() };
        self.points[c] = from + edge * ratio.x + left_normal(edge) * height;
    }

    /// Compares the sides of every face with those of its shape at the best common scale.
    fn measure_misfit(&mut self, patch: &Patch, shapes: &[Shape]) {
        let (mut length, mut misfit) = (0.0, 0.0f64);
        for ((corners, shape), &facing) in patch.corners().iter().zip(shapes).zip(&self.facing) {
            if facing == Facing::Unreached {
                continue;
            }
            let lies = corners.map(|corner| self.points[corner as usize]);
            let [[p, q, r], [a, b, c]] = [&lies, shape].map(|at| sides_of(at).map(|side| side.norm()));
            length += p + q + r;
            let scale = (p + q + r) / (a + b + c).max(f64::MIN_POSITIVE);
            let largest = (p - a * scale).abs().max((q - b * scale).abs()).max((r - c * scale).abs());
            misfit = misfit.max(largest / p.max(q).max(r).max(f64::MIN_POSITIVE));
        }
        (self.length, self.misfit) = (length, misfit);
    }
}

/// Length of a common edge in the shape of `face` over that in the shape of `next`; 1 where it has none.
fn ratio_of_sides(patch: &Patch, shapes: &[Shape], face: usize, side: usize, next: usize) -> f64 {
    let ends = [patch.corners()[face][side], patch.corners()[face][(side + 1) % 3]];
    let mut there = [Point2::origin(); 2];
    for (&vertex, &point) in patch.corners()[next].iter().zip(&shapes[next]) {
        for (end, slot) in ends.iter().zip(&mut there) {
            if *end == vertex {
                *slot = point;
            }
        }
    }
    let ratio = (shapes[face][(side + 1) % 3] - shapes[face][side]).norm() / (there[1] - there[0]).norm();
    if ratio.is_finite() && ratio > 0.0 { ratio } else { 1.0 }
}

/// How the face `next` must lie beside a neighbour `face` that lies as `known`, so that they don't overlap.
fn facing_beside(known: Facing, is_same_way: bool, shapes: &[Shape], face: usize, next: usize) -> Facing {
    let winding = |at: usize| {
        let [a, b, c] = shapes[at];
        (b - a).perp(&(c - a)) >= 0.0
    };
    // The winding in the plane is that of the shape, mirrored or not. Neighbours that name their common side in the
    // same direction need opposite windings.
    let is_left_wound = winding(face) == (known == Facing::Straight);
    if winding(next) == (is_left_wound != is_same_way) { Facing::Straight } else { Facing::Mirrored }
}
