//! The tree: what is built once for each mesh.

use super::{
    aabb::{Aabb, AabbX8, WIDTH},
    adjacency::LeafAdjacency,
    build::sort_by_median_splits,
    hubs::{Hubs, group_by_hub},
    single_map::{PointF32, is_far},
};
use crate::{
    frame::Frame,
    mesh::{FaceId, Mesh, MeshIdentity, VertexId},
};

/// A pair of nodes of one level whose subtrees are to be traversed against each other.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NodePair {
    pub(super) level: usize,
    pub(super) nodes: [u32; 2],
}

/// Bounding volume hierarchy over the usable faces of one mesh.
#[derive(Debug, Default)]
pub(crate) struct Bvh {
    /// The usable faces, neighbours in space side by side. A *place* is an index into it.
    order: Vec<FaceId>,
    /// Corners of the faces in `order`.
    pub(super) corners: Vec<[VertexId; 3]>,
    /// Boxes of the nodes, from the leaves up; the last level has one node.
    pub(super) levels: Vec<Vec<AabbX8>>,
    pub(super) points_f32: Vec<PointF32>,
    /// Of the map into single precision.
    pub(super) scale: f64,
    /// Whether some vertices are so far away that the map does not resolve them.
    pub(super) has_far: bool,
    /// Pairs of faces that the traversal leaves out.
    pub(super) adjacency: LeafAdjacency,
    /// The common vertices of nodes all of whose faces meet in a vertex of many faces.
    hubs: Hubs,
    /// Of the mesh for which the tree was built.
    identity: Option<MeshIdentity>,
}

impl Bvh {
    /// Builds the tree unless it is that of this mesh already; true if it was built.
    ///
    /// Any order of the usable faces gives the right pairs. The one chosen here, from the frame at hand, gives them
    /// fast.
    pub(crate) fn prepare(&mut self, mesh: &Mesh, frame: &Frame) -> bool {
        let is_new = self.identity.as_ref() != Some(mesh.identity());
        if is_new {
            self.identity = Some(mesh.identity().clone());
            self.order = mesh.face_ids().filter(|&face| mesh.face_edges(face).is_some()).collect();
            let centroid = |face: FaceId| {
                let [a, b, c] = mesh.face(face).map(|vertex| frame.position(vertex).coords);
                (a + b + c).into()
            };
            for alike in group_by_hub(mesh, &mut self.order) {
                sort_by_median_splits(&mut self.order[alike], &centroid);
            }
            self.hubs = Hubs::new(mesh, &self.order);
            self.corners.clear();
            self.corners.extend(self.order.iter().map(|&face| mesh.face(face)));
            self.adjacency = LeafAdjacency::new(mesh, &self.order);
            self.levels.clear();
            let mut num_nodes = self.order.len().div_ceil(WIDTH);
            self.levels.push(vec![AabbX8::EMPTY; num_nodes]);
            while num_nodes > 1 {
                num_nodes = num_nodes.div_ceil(WIDTH);
                self.levels.push(vec![AabbX8::EMPTY; num_nodes]);
            }
        }
        is_new
    }

    /// The root against itself; none without faces.
    pub(super) fn root_pair(&self) -> Option<NodePair> {
        let level = self.levels.len().checked_sub(1).filter(|_| !self.order.is_empty())?;
        Some(NodePair { level, nodes: [0, 0] })
    }

    /// Whether all faces of two nodes of a level share one vertex, or are faces of bodies, so that no pair of theirs is
    /// searched for.
    #[inline(always)]
    pub(super) fn have_common_hub(&self, level: usize, a: u32, b: u32) -> bool {
        self.adjacency.is_incomplete() && self.hubs.is_common(level, a, b)
    }

    /// Whether all faces of two nodes of a level are faces of bodies.
    #[inline(always)]
    pub(super) fn are_bodies(&self, level: usize, a: u32, b: u32) -> bool {
        self.hubs.are_bodies(level, a, b)
    }

    /// The box of a node below the root.
    #[inline(always)]
    pub(super) fn aabb(&self, level: usize, node: u32) -> Aabb {
        self.levels[level + 1][node as usize / WIDTH].get(node as usize % WIDTH)
    }

    /// Whether some vertices of the frame are far from all others, so that boxes are to be trusted, but nothing else in
    /// single precision that [`is_far`](Self::is_far) tells.
    #[inline(always)]
    pub(crate) fn has_far(&self) -> bool {
        self.has_far
    }

    /// Whether a vertex is far from all others.
    #[inline(always)]
    pub(crate) fn is_far(&self, vertex: u32) -> bool {
        is_far(self.points_f32[vertex as usize])
    }

    /// One bit for each of eight lanes in which there is a far vertex, by rows of vertices.
    #[inline(always)]
    pub(crate) fn far_lanes<'a>(&self, rows: impl Iterator<Item = &'a [u32; WIDTH]>) -> u32 {
        let mut far = 0;
        for row in rows {
            for (lane, &vertex) in row.iter().enumerate() {
                far |= u32::from(self.is_far(vertex)) << lane;
            }
        }
        far
    }

    /// One over the largest extent of the frame, in metres; far vertices aside.
    pub(crate) fn scale(&self) -> f64 {
        self.scale
    }

    /// All vertices after the map into single precision.
    #[inline(always)]
    pub(crate) fn points_f32(&self) -> &[PointF32] {
        &self.points_f32
    }

    /// All faces in the order of the tree.
    pub(crate) fn faces(&self) -> &[FaceId] {
        &self.order
    }

    /// The corners of all faces in the order of the tree.
    pub(crate) fn all_corners(&self) -> &[[VertexId; 3]] {
        &self.corners
    }

    /// The face at a place in the order of the tree.
    #[inline(always)]
    pub(crate) fn face(&self, place: u32) -> FaceId {
        self.order[place as usize]
    }

    /// The corners of the face at a place in the order of the tree.
    #[inline(always)]
    pub(crate) fn corners(&self, place: u32) -> [VertexId; 3] {
        self.corners[place as usize]
    }

    /// Whether the traversal may report pairs that are left out: those that share a vertex, one of more than
    /// [`MAX_ADJACENT_FACES`](super::MAX_ADJACENT_FACES) faces, and those of two faces of bodies.
    pub(crate) fn may_report_left_out(&self) -> bool {
        self.adjacency.is_incomplete()
    }
}
