//! One share of a search: pairs of faces and of primitives, batch by batch through the filters, to exact decisions.

use super::{
    goal::Goal,
    owners::Owners,
    pair::{Primitives, ProximityPair},
    stars::Stars,
};
use crate::{
    frame::Frame,
    intersect::{Bvh, NodePair, WIDTH, apart_edges_mask_x8, apart_mask_x8, apart_vertex_face_mask_x8},
    mesh::{FaceId, Mesh, VertexId},
    simd::{InstructionSet, Task},
};

/// Pairs of faces that are collected before they are tested: few enough to stay in the first cache.
const BATCH: usize = 256;

/// What is found in one share, and its scratch memory.
#[derive(Debug, Default)]
pub(super) struct Share {
    pub(super) found: Vec<ProximityPair>,
    stack: Vec<NodePair>,
    faces: Vec<[u32; 2]>,
    vertex_faces: Vec<Candidate>,
    edges: Vec<Candidate>,
    pub(super) spokes: Vec<[f64; 2]>,
    pub(super) open: Vec<VertexId>,
}

/// Two primitives and their vertices.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    vertices: [u32; 4],
    primitives: Primitives,
}

/// What a search works with.
#[derive(Clone, Copy)]
pub(super) struct Scene<'a> {
    pub(super) mesh: &'a Mesh,
    pub(super) frame: &'a Frame,
    pub(super) bvh: &'a Bvh,
    pub(super) owners: &'a Owners,
    pub(super) stars: &'a Stars,
    pub(super) goal: Goal<'a>,
}

/// What a share consists of.
pub(super) enum Part<'a> {
    /// Pairs of faces of each of these leaves.
    Leaves(&'a [usize]),
    /// Pairs of faces that share the centre of one of these open stars.
    Stars(&'a [VertexId]),
    /// Pairs of faces that share no vertex: every `step`th pair of subtrees, from `first` on.
    Subtrees { all: &'a [NodePair], first: usize, step: usize },
}

/// The work of one share.
pub(super) struct Work<'a> {
    pub(super) scene: Scene<'a>,
    pub(super) share: &'a mut Share,
    pub(super) part: Part<'a>,
}

impl Task for Work<'_> {
    #[inline(always)]
    fn run<S: InstructionSet>(self, simd: S) {
        let Self { scene, share, part } = self;
        match part {
            Part::Leaves(leaves) => leaves.iter().for_each(|&leaf| scene.push_leaf(leaf, share)),
            Part::Stars(centres) => {
                for &centre in centres {
                    scene.push_star(centre, share);
                    scene.flush(simd, share, BATCH);
                }
            }
            Part::Subtrees { all, first, step } => {
                for &subtrees in all.iter().skip(first).step_by(step) {
                    share.stack.push(subtrees);
                    scene.traverse(simd, share);
                }
            }
        }
        scene.flush(simd, share, 1);
    }
}

impl Scene<'_> {
    /// All primitives of the faces of a leaf.
    fn push_leaf(&self, leaf: usize, share: &mut Share) {
        let places = self.bvh.leaf_places(leaf);
        for first in places.clone() {
            (first + 1..places.end).for_each(|second| self.push_primitives([first, second], share));
        }
    }

    /// The primitives of the faces round the centre of an open star.
    fn push_star(&self, centre: VertexId, share: &mut Share) {
        let faces = self.mesh.vertex_faces(centre);
        for (index, &first) in faces.iter().enumerate() {
            for &second in &faces[index + 1..] {
                if self.stars.has_pair(centre, [first, second].map(|face: FaceId| self.mesh.face(face))) {
                    self.push_primitives([first, second].map(|face| self.owners.place(face)), share);
                }
            }
        }
    }

    /// Pairs of primitives without a common vertex that a pair of faces answers for.
    #[inline(always)]
    fn push_primitives(&self, places: [u32; 2], share: &mut Share) {
        let Self { mesh, bvh, owners, .. } = *self;
        if mesh.has_body() && places.iter().all(|&place| mesh.is_body_face(bvh.face(place))) {
            return;
        }
        for [own, other] in [places, [places[1], places[0]]] {
            let (face, corners) = (bvh.face(other), bvh.corners(other));
            for vertex in owners.vertices(bvh, own).filter(|vertex| !corners.contains(vertex)) {
                let vertices = [vertex.0, corners[0].0, corners[1].0, corners[2].0];
                share.vertex_faces.push(Candidate { vertices, primitives: Primitives::VertexFace { vertex, face } });
            }
        }
        for (first, [a, b]) in owners.edges(bvh, places[0]) {
            for (second, [c, d]) in owners.edges(bvh, places[1]) {
                if a != c && a != d && b != c && b != d {
                    let vertices = [a.0, b.0, c.0, d.0];
                    share.edges.push(Candidate { vertices, primitives: Primitives::edges(first, second) });
                }
            }
        }
    }

    /// Goes down from the pairs of nodes on the stack.
    #[inline(always)]
    fn traverse(&self, simd: impl InstructionSet, share: &mut Share) {
        while !share.stack.is_empty() && !self.goal.is_over(&share.found) {
            let margin = self.goal.margin(self.bvh);
            share.faces.clear();
            self.bvh.near_faces(simd, margin, &mut share.stack, BATCH, &mut share.faces);
            self.drop_apart(simd, margin, &mut share.faces);
            for index in 0..share.faces.len() {
                self.push_primitives(share.faces[index], share);
            }
            self.flush(simd, share, BATCH);
        }
        share.stack.clear();
    }

    /// Drops the pairs of faces that are proven to be farther apart than the margin.
    #[inline(always)]
    fn drop_apart(&self, simd: impl InstructionSet, margin: f32, pairs: &mut Vec<[u32; 2]>) {
        let mut corners = [[[0; WIDTH]; 3]; 2];
        let mut num_kept = 0;
        for first in (0..pairs.len()).step_by(WIDTH) {
            let num_pairs = WIDTH.min(pairs.len() - first);
            for lane in 0..num_pairs {
                for (triangle, place) in corners.iter_mut().zip(pairs[first + lane]) {
                    for (corner, vertex) in triangle.iter_mut().zip(self.bvh.corners(place)) {
                        corner[lane] = vertex.0;
                    }
                }
            }
            // The other lanes keep what earlier pairs left there.
            let used = 0xff >> (WIDTH - num_pairs);
            let mut near = !apart_mask_x8(simd.f32x8(), self.bvh.points_f32(), &corners, margin);
            if self.bvh.has_far() {
                near |= self.bvh.far_lanes(corners.iter().flatten());
            }
            near &= used;
            while near != 0 {
                pairs[num_kept] = pairs[first + near.trailing_zeros() as usize];
                near &= near - 1;
                num_kept += 1;
            }
        }
        pairs.truncate(num_kept);
    }

    /// Decides about the pairs of primitives, once there are so many.
    #[inline(always)]
    fn flush(&self, simd: impl InstructionSet, share: &mut Share, at_least: usize) {
        let Share { vertex_faces, edges, found, .. } = share;
        if vertex_faces.len() >= at_least {
            for eight in vertex_faces.chunks(WIDTH) {
                self.decide::<true>(simd, eight, found);
            }
            vertex_faces.clear();
        }
        if edges.len() >= at_least {
            for eight in edges.chunks(WIDTH) {
                self.decide::<false>(simd, eight, found);
            }
            edges.clear();
        }
    }

    /// Decides about up to eight pairs of a vertex and a face, or of edges, of which a filter leaves few.
    #[inline(always)]
    fn decide<const IS_VERTEX_FACE: bool>(
        &self,
        simd: impl InstructionSet,
        eight: &[Candidate],
        found: &mut Vec<ProximityPair>,
    ) {
        let mut rows = [[eight[0].vertices[0]; WIDTH]; 4];
        for (lane, candidate) in eight.iter().enumerate() {
            for (row, vertex) in rows.iter_mut().zip(candidate.vertices) {
                row[lane] = vertex;
            }
        }
        let (points, margin) = (self.bvh.points_f32(), self.goal.margin(self.bvh));
        let mut near = !if IS_VERTEX_FACE {
            apart_vertex_face_mask_x8(simd.f32x8(), points, &rows, margin)
        } else {
            apart_edges_mask_x8(simd.f32x8(), points, &rows, margin)
        };
        if self.bvh.has_far() {
            near |= self.bvh.far_lanes(rows.iter());
        }
        near &= 0xff >> (WIDTH - eight.len());
        while near != 0 {
            let candidate = &eight[near.trailing_zeros() as usize];
            near &= near - 1;
            self.goal.offer(self.mesh, self.frame, candidate.primitives, found);
        }
    }
}
