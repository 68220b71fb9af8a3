//! Refit: the boxes of a frame, from the leaves up.

use rayon::prelude::*;

use super::{
    aabb::{Aabb, AabbX8, WIDTH},
    tree::{Bvh, PointF32},
};
use crate::{frame::Frame, mesh::VertexId};

/// Least number of nodes that one thread takes at a time.
const MIN_NODES_PER_TASK: usize = 256;

/// The same for vertices, which cost less.
const MIN_VERTICES_PER_TASK: usize = 4096;

/// Coordinates in single precision are at most one half, and at most this far from where the map without rounding would
/// take them: twice the roundoff of the conversion.
pub(crate) const POINT_F32_ERROR: f64 = 0.25 * f32::EPSILON as f64;

impl Bvh {
    /// Fits all boxes to the positions of a frame.
    ///
    /// Cost: linear in vertices and faces, in parallel.
    pub(crate) fn refit(&mut self, frame: &Frame) {
        self.map_vertices(frame);
        self.refit_boxes();
    }

    /// Maps the vertices into single precision.
    fn map_vertices(&mut self, frame: &Frame) {
        let positions = frame.positions();
        let empty = || ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        let union = |a: ([f64; 3], [f64; 3]), b: ([f64; 3], [f64; 3])| {
            let low = std::array::from_fn(|axis| a.0[axis].min(b.0[axis]));
            (low, std::array::from_fn(|axis| a.1[axis].max(b.1[axis])))
        };
        let boxes = positions.par_chunks(MIN_VERTICES_PER_TASK).map(|chunk| {
            chunk.iter().fold(empty(), |aabb, &position| {
                let position: [f64; 3] = position.into();
                union(aabb, (position, position))
            })
        });
        let (low, high) = boxes.reduce(empty, union);
        let centre: [f64; 3] = std::array::from_fn(|axis| low[axis].midpoint(high[axis]));
        let extent = (0..3).map(|axis| high[axis] - low[axis]).fold(0.0, f64::max);
        // Where all vertices are in one point any scale is right.
        let scale = if extent > 0.0 { 1.0 / extent } else { 1.0 };
        self.scale = scale;
        self.points_f32.resize(positions.len(), PointF32::default());
        let points_f32 = self.points_f32.par_iter_mut().with_min_len(MIN_VERTICES_PER_TASK).zip(positions);
        points_f32.for_each(|(point, position)| {
            #[expect(clippy::cast_possible_truncation, reason = "monotone, which is all that is needed")]
            let map = |axis: usize| ((position[axis] - centre[axis]) * scale) as f32;
            *point = [map(0), map(1), map(2), 0.0];
        });
    }

    fn refit_boxes(&mut self) {
        let points = &self.points_f32;
        let refit_leaf = |(node, faces): (&mut AabbX8, &[[VertexId; 3]])| {
            for (slot, [a, b, c]) in faces.iter().enumerate() {
                node.set(slot, Aabb::of_triangle([&points[a.index()], &points[b.index()], &points[c.index()]]));
            }
        };
        let refit_node = |(node, children): (&mut AabbX8, &[AabbX8])| {
            for (slot, child) in children.iter().enumerate() {
                node.set(slot, child.union());
            }
        };
        let leaves = self.levels[0].par_iter_mut().with_min_len(MIN_NODES_PER_TASK);
        leaves.zip(self.corners.par_chunks(WIDTH)).for_each(refit_leaf);
        for level in 1..self.levels.len() {
            let (below, above) = self.levels.split_at_mut(level);
            let nodes = above[0].par_iter_mut().with_min_len(MIN_NODES_PER_TASK);
            nodes.zip(below[level - 1].par_chunks(WIDTH)).for_each(refit_node);
        }
    }
}
