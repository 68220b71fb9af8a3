//! Pairs of primitives of two faces whose boxes come within a margin of each other.

use super::{
    owners::{Owners, edge_of},
    pair::Primitives,
};
use crate::{
    intersect::{Bvh, NodePair, PointF32},
    mesh::{Mesh, VertexId},
    simd::InstructionSet,
};

/// What the tests of boxes need.
#[derive(Clone, Copy)]
pub(super) struct Candidates<'a> {
    pub(super) mesh: &'a Mesh,
    pub(super) bvh: &'a Bvh,
    pub(super) owners: &'a Owners,
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
        let mut pairs = self.bvh.near_slots(simd, margin, leaves);
        while pairs != 0 {
            let (slot, other) = (pairs.trailing_zeros() / 8, pairs.trailing_zeros() % 8);
            pairs &= pairs - 1;
            if a != b || slot < other {
                self.of_faces(margin, [8 * a + slot, 8 * b + other], &mut found);
            }
        }
    }

    #[inline(always)]
    fn of_faces(&self, margin: f32, places: [u32; 2], found: &mut impl FnMut(Primitives)) {
        if places.iter().all(|&place| self.mesh.is_body_face(self.bvh.face(place))) {
            return;
        }
        let corners = places.map(|place| self.bvh.corners(place));
        for side in [0, 1] {
            let (place, other) = (places[side], places[1 - side]);
            for vertex in self.owners.vertices(place, corners[side]) {
                if !corners[1 - side].contains(&vertex) && self.may_be_near(margin, &[vertex], &corners[1 - side]) {
                    found(Primitives::VertexFace { vertex, face: self.bvh.face(other) });
                }
            }
        }
        let ends = |side: usize, edge: usize| [corners[side][edge], corners[side][(edge + 1) % 3]];
        let seconds = self.owners.sides(places[1]);
        for own in self.owners.sides(places[0]) {
            let first = ends(0, own);
            for other in seconds.clone() {
                let second = ends(1, other);
                let share = second.contains(&first[0]) || second.contains(&first[1]);
                if !share && self.may_be_near(margin, &first, &second) {
                    let [face, other_face] = places.map(|place| self.bvh.face(place));
                    found(Primitives::edges(edge_of(self.mesh, face, own), edge_of(self.mesh, other_face, other)));
                }
            }
        }
    }

    /// Whether the boxes of two primitives come within the margin of each other.
    #[inline(always)]
    fn may_be_near<const N: usize, const M: usize>(
        &self,
        margin: f32,
        first: &[VertexId; N],
        second: &[VertexId; M],
    ) -> bool {
        let points = self.bvh.points_f32();
        let (first, second) = (bounds(points, first), bounds(points, second));
        (0..3).all(|axis| {
            let margin = margin + self.bvh.rounding_of_far(first[0][axis].abs().max(first[1][axis].abs()));
            first[0][axis] - margin <= second[1][axis] && second[0][axis] <= first[1][axis] + margin
        })
    }
}

#[inline(always)]
fn bounds<const N: usize>(points: &[PointF32], vertices: &[VertexId; N]) -> [[f32; 3]; 2] {
    let point = |vertex: VertexId| {
        let [x, y, z, _] = points[vertex.0 as usize];
        [x, y, z]
    };
    let (mut low, mut high) = (point(vertices[0]), point(vertices[0]));
    for &vertex in &vertices[1..] {
        let point = point(vertex);
        for axis in 0..3 {
            low[axis] = if point[axis] < low[axis] { point[axis] } else { low[axis] };
            high[axis] = if point[axis] > high[axis] { point[axis] } else { high[axis] };
        }
    }
    [low, high]
}
