//! Pairs of primitives of two leaves whose boxes come within a margin of each other.

use super::{
    elements::{Elements, bounds},
    pair::Primitives,
};
use crate::{
    intersect::{Bvh, NodePair, WIDTH},
    mesh::{Mesh, VertexId},
    simd::InstructionSet,
};

/// What the tests of boxes need.
#[derive(Clone, Copy)]
pub(super) struct Candidates<'a> {
    pub(super) mesh: &'a Mesh,
    pub(super) bvh: &'a Bvh,
    pub(super) elements: &'a Elements,
}

impl Candidates<'_> {
    /// Calls `found` once for each pair of primitives that belongs to a pair of leaves and may be within the margin, in
    /// single precision after the map of the tree.
    #[inline(always)]
    pub(super) fn of_leaves(
        &self,
        simd: impl InstructionSet,
        margin: f32,
        leaves: NodePair,
        mut found: impl FnMut(Primitives),
    ) {
        let [a, b] = Bvh::leaf_nodes(leaves);
        self.vertices_and_faces(simd, margin, [a, b], &mut found);
        if a != b {
            self.vertices_and_faces(simd, margin, [b, a], &mut found);
        }
        self.edges(simd, margin, [a, b], &mut found);
    }

    /// The vertices of one leaf and the faces of another one.
    #[inline(always)]
    fn vertices_and_faces(
        &self,
        simd: impl InstructionSet,
        margin: f32,
        [own, other]: [u32; 2],
        found: &mut impl FnMut(Primitives),
    ) {
        let boxes = self.bvh.face_boxes(other);
        for &vertex in self.elements.vertices(own) {
            let near = self.bvh.inflated(&bounds(self.bvh.points_f32(), &[vertex]), margin);
            let mut hits = boxes.overlap_mask(simd, &near);
            while hits != 0 {
                let place = 8 * other + hits.trailing_zeros();
                hits &= hits - 1;
                let corners = self.bvh.corners(place);
                if !corners.contains(&vertex) && !self.are_bodies(vertex, corners[0]) {
                    found(Primitives::VertexFace { vertex, face: self.bvh.face(place) });
                }
            }
        }
    }

    /// Whether both belong to bodies.
    #[inline(always)]
    fn are_bodies(&self, first: VertexId, second: VertexId) -> bool {
        self.mesh.is_body(first) && self.mesh.is_body(second)
    }

    /// The edges of both leaves, or of one.
    #[inline(always)]
    fn edges(&self, simd: impl InstructionSet, margin: f32, [a, b]: [u32; 2], found: &mut impl FnMut(Primitives)) {
        let (edges, boxes) = self.elements.edges(a);
        let (others, other_boxes) = self.elements.edges(b);
        for (index, &(edge, ends)) in edges.iter().enumerate() {
            let near = self.bvh.inflated(&boxes[index / WIDTH].get(index % WIDTH), margin);
            for (chunk, eight) in other_boxes.iter().enumerate() {
                let mut hits = eight.overlap_mask(simd, &near);
                while hits != 0 {
                    let at = WIDTH * chunk + hits.trailing_zeros() as usize;
                    hits &= hits - 1;
                    let (other, other_ends) = others[at];
                    if (a != b || at > index)
                        && !share_an_end(ends, other_ends)
                        && !self.are_bodies(ends[0], other_ends[0])
                    {
                        found(Primitives::edges(edge, other));
                    }
                }
            }
        }
    }
}

#[inline(always)]
fn share_an_end([a, b]: [VertexId; 2], [c, d]: [VertexId; 2]) -> bool {
    (a == c) | (a == d) | (b == c) | (b == d)
}
