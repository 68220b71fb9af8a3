//! Refit: the boxes of a frame, from the leaves up.

use rayon::prelude::*;

use super::{
    aabb::{Aabb, AabbX8, WIDTH},
    single_map::SingleMap,
    tree::Bvh,
};
use crate::{frame::Frame, mesh::VertexId};

/// Least number of nodes that one thread takes at a time.
const MIN_NODES_PER_TASK: usize = 256;

/// Coordinates in single precision are at most one, those of [far](Bvh::is_far) vertices aside, and at most this far
/// from where the map without rounding would take them: half a unit in the last place below one, and what the steps in
/// double precision add. Most are at most one half, but not where the middle of a frame is rounded to its end.
pub(crate) const POINT_F32_ERROR: f64 = (0.25 + 1e-6) * f32::EPSILON as f64;

impl Bvh {
    /// Fits all boxes to the positions of a frame.
    ///
    /// Cost: linear in vertices and faces, in parallel.
    pub(crate) fn refit(&mut self, frame: &Frame) {
        let map = SingleMap::of(frame.positions());
        map.apply(frame.positions(), &mut self.points_f32);
        (self.scale, self.has_far) = (map.scale, map.has_far);
        self.refit_boxes();
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
