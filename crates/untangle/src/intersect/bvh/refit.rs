//! Refit: the boxes of a frame, from the leaves up. Those of bodies that stay are left as they are.

use std::ops::Range;

use rayon::prelude::*;

use super::{
    aabb::{Aabb, AabbX8, WIDTH},
    single_map::{SingleMap, bounds_of},
    tree::Bvh,
};
use crate::{
    frame::Frame,
    mesh::{Mesh, VertexId},
};

/// Least number of nodes that one thread takes at a time.
const MIN_NODES_PER_TASK: usize = 256;

/// Coordinates in single precision are at most one, those of [far](Bvh::is_far) vertices aside, and at most this far
/// from where the map without rounding would take them: half a unit in the last place below one, and what the steps in
/// double precision add. Most are at most one half, but not where the middle of a frame is rounded to its end.
pub(crate) const POINT_F32_ERROR: f64 = (0.25 + 1e-6) * f32::EPSILON as f64;

impl Bvh {
    /// Fits all boxes to the positions of a frame of the mesh that the tree is of.
    ///
    /// Cost: linear in vertices and faces, in parallel; of bodies that are where they were at the last time nothing.
    pub(crate) fn refit(&mut self, mesh: &Mesh, frame: &Frame) {
        let positions = frame.positions();
        let is_still = frame.body_version().is_still(self.fitted.body);
        self.fitted.body = frame.body_version();
        let bounds = bounds_of(mesh, positions, is_still, &mut self.fitted.body_bounds);
        let map = SingleMap::of(positions, bounds, mesh.has_body());
        let keeps_bodies = is_still && map == self.fitted.map;
        self.fitted.map = map;
        map.apply(positions, |block| keeps_bodies && mesh.is_body_block(block), &mut self.points_f32);
        self.refit_boxes(keeps_bodies);
    }

    fn refit_boxes(&mut self, keeps_bodies: bool) {
        let Self { points_f32: points, corners, levels, hubs, .. } = self;
        let kept = |level: usize| if keeps_bodies { hubs.bodies(level) } else { 0..0 };
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
        for (nodes, faces) in but_for(kept(0), &mut levels[0], corners) {
            let nodes = nodes.par_iter_mut().with_min_len(MIN_NODES_PER_TASK);
            nodes.zip(faces.par_chunks(WIDTH)).for_each(refit_leaf);
        }
        for level in 1..levels.len() {
            let (below, above) = levels.split_at_mut(level);
            for (nodes, children) in but_for(kept(level), &mut above[0], &below[level - 1]) {
                let nodes = nodes.par_iter_mut().with_min_len(MIN_NODES_PER_TASK);
                nodes.zip(children.par_chunks(WIDTH)).for_each(refit_node);
            }
        }
    }
}

/// Nodes and what is below them, without a range of nodes: those before it, and those after it.
fn but_for<'a, T>(kept: Range<usize>, nodes: &'a mut [AabbX8], below: &'a [T]) -> [(&'a mut [AabbX8], &'a [T]); 2] {
    let (before, rest) = nodes.split_at_mut(kept.start);
    let end = |node: usize| (WIDTH * node).min(below.len());
    [(before, &below[..end(kept.start)]), (&mut rest[kept.len()..], &below[end(kept.end)..])]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{MeshDescription, VERTICES_PER_BLOCK};

    /// Separate triangles along a line, the first `num_body` of them a body's.
    fn triangles(count: u32, num_body: u32) -> (Mesh, Vec<[f64; 3]>) {
        let faces = (0..count).map(|face| [3 * face, 3 * face + 1, 3 * face + 2]).collect();
        let body = (0..3 * num_body).collect();
        let num_vertices = 3 * count as usize;
        let mesh = Mesh::new(MeshDescription { num_vertices, faces, body, ..Default::default() }).unwrap();
        let place = |vertex: u32| [f64::from(vertex / 3), f64::from(vertex % 3), f64::from(vertex % 2)];
        (mesh, (0..3 * count).map(place).collect())
    }

    /// All coordinates of all boxes but the empty ones.
    fn boxes(bvh: &Bvh) -> Vec<[[f32; 3]; 2]> {
        let all = bvh.levels.iter().flatten().flat_map(|node| (0..WIDTH).map(|slot| node.get(slot)));
        all.filter(|aabb| aabb.min[0] <= aabb.max[0]).map(|aabb| [aabb.min, aabb.max]).collect()
    }

    fn fresh_boxes(mesh: &Mesh, frame: &Frame, like: &Bvh) -> Vec<[[f32; 3]; 2]> {
        let mut bvh = Bvh::default();
        bvh.prepare(mesh, frame);
        assert_eq!(bvh.faces(), like.faces(), "what moves here does not change the order");
        bvh.refit(mesh, frame);
        boxes(&bvh)
    }

    /// Makes the nodes of bodies and their points useless, and counts the nodes.
    fn spoil_bodies(mesh: &Mesh, bvh: &mut Bvh) -> usize {
        let mut num_nodes = 0;
        for (level, nodes) in bvh.levels.iter_mut().enumerate() {
            let bodies = bvh.hubs.bodies(level);
            num_nodes += bodies.len();
            nodes[bodies].fill(AabbX8::EMPTY);
        }
        let of_bodies = bvh.points_f32.chunks_mut(VERTICES_PER_BLOCK).enumerate();
        of_bodies.filter(|(block, _)| mesh.is_body_block(*block)).for_each(|(_, points)| points.fill([9.0; 4]));
        num_nodes
    }

    #[test]
    fn refit_does_no_work_for_bodies_that_are_still_and_all_of_it_where_they_or_the_map_moved() {
        // Leaves and blocks that hold both.
        let (mesh, mut positions) = triangles(3000, 2003);
        let mut frame = Frame::new(&mesh, &positions).unwrap();
        let mut bvh = Bvh::default();
        bvh.prepare(&mesh, &frame);
        let mut refit = |bvh: &mut Bvh, positions: &[[f64; 3]]| {
            frame.set(&mesh, positions.iter().copied()).unwrap();
            bvh.refit(&mesh, &frame);
            boxes(bvh) == fresh_boxes(&mesh, &frame, bvh)
        };
        assert!(refit(&mut bvh, &positions));
        // Cloth moves: the boxes are those of a tree that was never fitted before, and those of the body the old ones.
        positions[7000][1] += 0.25;
        assert!(refit(&mut bvh, &positions));
        positions[7000][1] += 0.25;
        assert!(spoil_bodies(&mesh, &mut bvh) > 250);
        assert!(!refit(&mut bvh, &positions), "the body was fitted again");
        let is_spoilt = |bvh: &Bvh| bvh.levels[0][bvh.hubs.bodies(0)].iter().all(|node| node.get(0).min[0] > 9.0);
        assert!(is_spoilt(&bvh) && bvh.points_f32[0].iter().all(|&along| along > 8.0));
        // The body moves.
        positions[5][2] += 0.25;
        assert!(refit(&mut bvh, &positions));
        // The frame gets so large that another map takes it to single precision.
        spoil_bodies(&mesh, &mut bvh);
        positions[8999][0] += 5000.0;
        assert!(refit(&mut bvh, &positions));
    }

    #[test]
    fn refit_of_a_mesh_without_bodies_keeps_nothing() {
        let (mesh, mut positions) = triangles(3000, 0);
        let mut frame = Frame::new(&mesh, &positions).unwrap();
        let mut bvh = Bvh::default();
        bvh.prepare(&mesh, &frame);
        for vertex in [0, 4000, 8999] {
            positions[vertex][2] += 0.5;
            frame.set(&mesh, positions.iter().copied()).unwrap();
            bvh.refit(&mesh, &frame);
            assert_eq!(boxes(&bvh), fresh_boxes(&mesh, &frame, &bvh));
        }
    }
}
