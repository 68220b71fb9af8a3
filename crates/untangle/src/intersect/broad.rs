//! Candidate pairs of faces: a tree of boxes, eight to a node, refitted each frame.
//!
//! The tree is implicit: faces stand in one array, sorted once so that neighbours in space are neighbours in the array; node
//! `g` of a level covers nodes `8 g .. 8 g + 8` of the level below. All leaves have the same depth, so that a pair of nodes is always a
//! pair of one level.
//!
//! Boxes are in single precision. Coordinates get there by one map for the whole frame, `x -> f32((x - centre) * scale)`. Each
//! of its steps is monotone in floating-point arithmetic, so intervals that overlap before the map overlap after it: no pair is lost, wherever
//! the cloth is and however large, and nothing needs to be rounded outwards.

mod within;

use rayon::prelude::*;

use super::{
    boxes::{Boxes, EMPTY, Hull, WIDTH, higher, lower},
    lanes::{Lanes, Portable},
    neighbours::Neighbours,
    rings::Rings,
    singles::Mapped,
};
use crate::{
    frame::Frame,
    mesh::{FaceId, Mesh, MeshIdentity, VertexId},
};

/// Nodes that one thread fits in one go, at least.
const LEAST_SHARE: usize = 256;

/// The same for vertices, which take less.
const SHARE_OF_VERTICES: usize = 4096;

/// Bits `8 i + k` of the pairs of places with `i < k`, and with `i = k`.
const ABOVE_DIAGONAL: u64 = 0x0080_c0e0_f0f8_fcfe;
const DIAGONAL: u64 = 0x8040_2010_0804_0201;

/// A pair of nodes of one level whose subtrees are to be searched against each other.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NodePair {
    level: usize,
    nodes: [u32; 2],
}

/// The tree over the usable faces of one mesh.
#[derive(Debug, Default)]
pub(crate) struct FaceTree {
    /// The usable faces, neighbours in space side by side.
    order: Vec<FaceId>,
    /// From the leaves up; the last has one node.
    levels: Vec<Vec<Boxes>>,
    /// Vertices after the map into single precision.
    mapped: Vec<Mapped>,
    /// Of the map.
    scale: f64,
    /// Corners of the faces in `order`.
    corners: Vec<[VertexId; 3]>,
    /// Faces that share a vertex: they always touch and are tested elsewhere.
    neighbours: Neighbours,
    rings: Rings,
    /// The mesh of all this.
    identity: Option<MeshIdentity>,
}

impl FaceTree {
    /// Sorts the faces when this mesh is met for the first time; true if so.
    ///
    /// Any order that lists exactly the usable faces gives the right pairs; a good one gives them fast.
    pub(crate) fn prepare(&mut self, mesh: &Mesh, frame: &Frame) -> bool {
        let is_new = self.identity.as_ref() != Some(mesh.identity());
        if is_new {
            self.identity = Some(mesh.identity().clone());
            self.order = mesh.face_ids().filter(|&face| mesh.face_edges(face).is_some()).collect();
            let centroid = |face: FaceId| {
                let [a, b, c] = mesh.face(face).map(|vertex| frame.position(vertex).coords);
                (a + b + c).into()
            };
            sort_in_space(&mut self.order, &centroid);
            self.corners.clear();
            self.corners.extend(self.order.iter().map(|&face| mesh.face(face)));
            self.neighbours = Neighbours::new(mesh, &self.order);
            self.rings = Rings::new(mesh, &self.order);
            self.levels.clear();
            let mut num_nodes = self.order.len().div_ceil(WIDTH);
            self.levels.push(vec![EMPTY; num_nodes]);
            while num_nodes > 1 {
                num_nodes = num_nodes.div_ceil(WIDTH);
                self.levels.push(vec![EMPTY; num_nodes]);
            }
        }
        is_new
    }

    /// Fits the boxes to a frame.
    pub(crate) fn fit(&mut self, frame: &Frame) {
        self.map_vertices(frame);
        self.refit();
    }

    fn map_vertices(&mut self, frame: &Frame) {
        let positions = frame.positions();
        let nothing = || ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        let joined = |one: ([f64; 3], [f64; 3]), other: ([f64; 3], [f64; 3])| {
            let low = std::array::from_fn(|axis| one.0[axis].min(other.0[axis]));
            (low, std::array::from_fn(|axis| one.1[axis].max(other.1[axis])))
        };
        let shares = positions.par_chunks(SHARE_OF_VERTICES);
        let boxes = shares.map(|share| {
            share.iter().fold(nothing(), |sum, &position| {
                let position: [f64; 3] = position.into();
                joined(sum, (position, position))
            })
        });
        let (low, high) = boxes.reduce(nothing, joined);
        let centre: [f64; 3] = std::array::from_fn(|axis| low[axis].midpoint(high[axis]));
        let extent = (0..3).map(|axis| high[axis] - low[axis]).fold(0.0, f64::max);
        // A frame in one point needs no scale.
        let scale = if extent > 0.0 { 1.0 / extent } else { 1.0 };
        self.scale = scale;
        self.mapped.resize(positions.len(), Mapped::default());
        let mapped = self.mapped.par_iter_mut().with_min_len(SHARE_OF_VERTICES).zip(positions);
        mapped.for_each(|(mapped, position)| {
            #[expect(clippy::cast_possible_truncation, reason = "monotone, which is all that is needed")]
            let map = |axis: usize| ((position[axis] - centre[axis]) * scale) as f32;
            *mapped = [map(0), map(1), map(2), 0.0];
        });
    }

    fn refit(&mut self) {
        let mapped = &self.mapped;
        let fit_leaf = |(node, faces): (&mut Boxes, &[[VertexId; 3]])| {
            for (slot, corners) in faces.iter().enumerate() {
                let [a, b, c] = [mapped[corners[0].index()], mapped[corners[1].index()], mapped[corners[2].index()]];
                let low = std::array::from_fn(|axis| lower(lower(a[axis], b[axis]), c[axis]));
                let high = std::array::from_fn(|axis| higher(higher(a[axis], b[axis]), c[axis]));
                node.set(slot, (low, high));
            }
        };
        let fit_node = |(node, children): (&mut Boxes, &[Boxes])| {
            for (slot, child) in children.iter().enumerate() {
                node.set(slot, child.hull());
            }
        };
        let leaves = self.levels[0].par_iter_mut().with_min_len(LEAST_SHARE);
        leaves.zip(self.corners.par_chunks(WIDTH)).for_each(fit_leaf);
        for level in 1..self.levels.len() {
            let (lower, upper) = self.levels.split_at_mut(level);
            let nodes = upper[0].par_iter_mut().with_min_len(LEAST_SHARE);
            nodes.zip(lower[level - 1].par_chunks(WIDTH)).for_each(fit_node);
        }
    }

    /// Splits the search into independent parts, about `num_wanted` squared over two of them before the search drops any.
    pub(crate) fn parts(&self, num_wanted: usize, parts: &mut Vec<NodePair>) {
        parts.clear();
        let Some(level) = (0..self.levels.len()).rev().find(|&level| self.levels[level].len() >= num_wanted) else {
            if let Some(top) = self.levels.len().checked_sub(1).filter(|_| !self.order.is_empty()) {
                parts.push(NodePair { level: top, nodes: [0, 0] });
            }
            return;
        };
        let num_nodes = u32::try_from(self.levels[level].len()).expect("fewer nodes than faces");
        parts.extend((0..num_nodes).map(|node| NodePair { level, nodes: [node, node] }));
        // The level has more than one node, so that there is one above it.
        for a in 0..num_nodes {
            let hull = self.hull(level, a);
            for (upper, boxes) in (0..).zip(&self.levels[level + 1]).skip(a as usize / WIDTH) {
                let mut hits = Portable.overlaps(boxes, &hull);
                while hits != 0 {
                    let b = 8 * upper + hits.trailing_zeros();
                    hits &= hits - 1;
                    if b > a {
                        parts.push(NodePair { level, nodes: [a, b] });
                    }
                }
            }
        }
    }

    /// The box round a node below the top.
    #[inline(always)]
    fn hull(&self, level: usize, node: u32) -> Hull {
        self.levels[level + 1][node as usize / WIDTH].get(node as usize % WIDTH)
    }

    /// Calls `found` once for each pair of faces in this part whose boxes overlap, but for those that share a vertex; faces are named by their places in the
    /// order of the tree.
    #[inline(always)]
    pub(crate) fn search(
        &self,
        lanes: impl Lanes,
        part: NodePair,
        stack: &mut Vec<NodePair>,
        mut found: impl FnMut([u32; 2]),
    ) {
        stack.clear();
        stack.push(part);
        while let Some(NodePair { level, nodes: [a, b] }) = stack.pop() {
            let boxes = &self.levels[level];
            let mut pairs = lanes.overlapping_pairs(&boxes[a as usize], &boxes[b as usize]);
            if a == b {
                // Each pair once; a node with itself only above the leaves.
                pairs &= if level == 0 { ABOVE_DIAGONAL } else { ABOVE_DIAGONAL | DIAGONAL };
            }
            if level == 0 {
                pairs &= !self.neighbours.between(a, b);
            }
            while pairs != 0 {
                let (slot, other) = (pairs.trailing_zeros() / 8, pairs.trailing_zeros() % 8);
                pairs &= pairs - 1;
                let children = [8 * a + slot, 8 * b + other];
                if level == 0 {
                    found(children);
                } else {
                    stack.push(NodePair { level: level - 1, nodes: children });
                }
            }
        }
    }

    /// All vertices after the map into single precision.
    #[inline(always)]
    pub(crate) fn mapped(&self) -> &[Mapped] {
        &self.mapped
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

    /// The rings of all vertices, neighbours in space side by side.
    pub(crate) fn rings(&self) -> &Rings {
        &self.rings
    }

    /// Whether pairs that share a vertex may be found all the same.
    pub(crate) fn misses_neighbours(&self) -> bool {
        self.neighbours.are_incomplete()
    }
}

/// Sorts by halving along the longest axis; the halves are powers of two, so that nodes of every level are halves of halves.
fn sort_in_space(faces: &mut [FaceId], centroid: &dyn Fn(FaceId) -> [f64; 3]) {
    if faces.len() <= WIDTH {
        return;
    }
    let mut low = [f64::INFINITY; 3];
    let mut high = [f64::NEG_INFINITY; 3];
    for &face in faces.iter() {
        for (axis, value) in centroid(face).into_iter().enumerate() {
            low[axis] = low[axis].min(value);
            high[axis] = high[axis].max(value);
        }
    }
    let extent = |axis: usize| high[axis] - low[axis];
    let axis = (1..3).fold(0, |best, axis| if extent(axis) > extent(best) { axis } else { best });
    let half = faces.len().div_ceil(2).next_power_of_two().min(faces.len() - 1);
    faces.select_nth_unstable_by(half, |&a, &b| centroid(a)[axis].total_cmp(&centroid(b)[axis]).then(a.cmp(&b)));
    let (left, right) = faces.split_at_mut(half);
    sort_in_space(left, centroid);
    sort_in_space(right, centroid);
}
