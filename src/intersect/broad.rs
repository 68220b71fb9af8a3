//! Candidate pairs of faces: a tree of boxes, eight to a node, refitted each frame.
//!
//! The tree is implicit: faces stand in one array, sorted once so that neighbours in space are neighbours in the array; node
//! `g` of a level covers nodes `8 g .. 8 g + 8` of the level below. All leaves have the same depth, so that a pair of nodes is always a
//! pair of one level.
//!
//! Boxes are in single precision. Coordinates get there by one map for the whole frame, `x -> f32((x - centre) * scale)`. Each
//! of its steps is monotone in floating-point arithmetic, so intervals that overlap before the map overlap after it: no pair is lost, wherever
//! the cloth is and however large, and nothing needs to be rounded outwards.

use crate::{
    frame::Frame,
    mesh::{FaceId, Mesh},
};

const WIDTH: usize = 8;

/// Eight boxes, one coordinate after the other. Unused places hold the empty box, which overlaps nothing.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct Boxes {
    min: [[f32; WIDTH]; 3],
    max: [[f32; WIDTH]; 3],
}

const EMPTY: Boxes = Boxes { min: [[f32::INFINITY; WIDTH]; 3], max: [[f32::NEG_INFINITY; WIDTH]; 3] };

impl Boxes {
    /// A bit for each of these boxes that overlaps box `slot` of `other`; touching counts.
    #[inline]
    fn overlaps(&self, other: &Self, slot: usize) -> u32 {
        let mut hits = [true; WIDTH];
        for axis in 0..3 {
            let (min, max) = (other.min[axis][slot], other.max[axis][slot]);
            for (lane, hit) in hits.iter_mut().enumerate() {
                *hit &= (self.min[axis][lane] <= max) & (self.max[axis][lane] >= min);
            }
        }
        hits.iter().enumerate().fold(0, |mask, (lane, &hit)| mask | (u32::from(hit) << lane))
    }

    fn include(&mut self, slot: usize, low: [f32; 3], high: [f32; 3]) {
        for axis in 0..3 {
            self.min[axis][slot] = self.min[axis][slot].min(low[axis]);
            self.max[axis][slot] = self.max[axis][slot].max(high[axis]);
        }
    }

    /// The box round all of them.
    fn hull(&self) -> ([f32; 3], [f32; 3]) {
        (
            self.min.map(|row| row.into_iter().fold(f32::INFINITY, f32::min)),
            self.max.map(|row| row.into_iter().fold(f32::NEG_INFINITY, f32::max)),
        )
    }
}

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
    mapped: Vec<[f32; 3]>,
    /// Scratch: the boxes round the nodes of one level.
    hulls: Vec<Boxes>,
}

impl FaceTree {
    /// Fits the boxes to a frame; sorts the faces first when this mesh is met for the first time.
    ///
    /// Any order that lists exactly the usable faces gives the right pairs; a good one gives them fast.
    pub(crate) fn fit(&mut self, mesh: &Mesh, frame: &Frame) {
        let fits = self.order.len() == mesh.num_faces() - mesh.num_ignored_faces()
            && self.order.iter().all(|face| face.index() < mesh.num_faces() && mesh.face_edges(*face).is_some());
        if !fits {
            self.order = mesh.face_ids().filter(|&face| mesh.face_edges(face).is_some()).collect();
            let centroid = |face: FaceId| {
                let [a, b, c] = mesh.face(face).map(|vertex| frame.position(vertex).coords);
                (a + b + c).into()
            };
            sort_in_space(&mut self.order, &centroid);
            self.levels.clear();
            let mut num_nodes = self.order.len().div_ceil(WIDTH);
            self.levels.push(vec![EMPTY; num_nodes]);
            while num_nodes > 1 {
                num_nodes = num_nodes.div_ceil(WIDTH);
                self.levels.push(vec![EMPTY; num_nodes]);
            }
        }
        self.map_vertices(frame);
        self.refit(mesh);
    }

    fn map_vertices(&mut self, frame: &Frame) {
        let positions = frame.positions();
        let mut low = [f64::INFINITY; 3];
        let mut high = [f64::NEG_INFINITY; 3];
        for position in positions {
            for axis in 0..3 {
                low[axis] = low[axis].min(position[axis]);
                high[axis] = high[axis].max(position[axis]);
            }
        }
        let centre: [f64; 3] = std::array::from_fn(|axis| low[axis].midpoint(high[axis]));
        let extent = (0..3).map(|axis| high[axis] - low[axis]).fold(0.0, f64::max);
        // A frame in one point needs no scale.
        let scale = if extent > 0.0 { 1.0 / extent } else { 1.0 };
        self.mapped.clear();
        self.mapped.extend(positions.iter().map(|position| {
            std::array::from_fn(|axis| {
                #[expect(clippy::cast_possible_truncation, reason = "monotone, which is all that is needed")]
                let mapped = ((position[axis] - centre[axis]) * scale) as f32;
                mapped
            })
        }));
    }

    fn refit(&mut self, mesh: &Mesh) {
        for (node, faces) in self.levels[0].iter_mut().zip(self.order.chunks(WIDTH)) {
            *node = EMPTY;
            for (slot, &face) in faces.iter().enumerate() {
                for vertex in mesh.face(face) {
                    let point = self.mapped[vertex.index()];
                    node.include(slot, point, point);
                }
            }
        }
        for level in 1..self.levels.len() {
            let (lower, upper) = self.levels.split_at_mut(level);
            for (node, children) in upper[0].iter_mut().zip(lower[level - 1].chunks(WIDTH)) {
                *node = EMPTY;
                for (slot, child) in children.iter().enumerate() {
                    let (low, high) = child.hull();
                    node.include(slot, low, high);
                }
            }
        }
    }

    /// Splits the search into independent parts, about `num_wanted` squared over two of them before the search drops any.
    pub(crate) fn parts(&mut self, num_wanted: usize, parts: &mut Vec<NodePair>) {
        parts.clear();
        let Some(level) = (0..self.levels.len()).rev().find(|&level| self.levels[level].len() >= num_wanted) else {
            if let Some(top) = self.levels.len().checked_sub(1) {
                parts.push(NodePair { level: top, nodes: [0, 0] });
            }
            return;
        };
        let num_nodes = u32::try_from(self.levels[level].len()).expect("fewer nodes than faces");
        parts.extend((0..num_nodes).map(|node| NodePair { level, nodes: [node, node] }));
        self.hulls.clear();
        self.hulls.extend(self.levels[level].iter().map(|node| {
            let mut boxes = EMPTY;
            let (low, high) = node.hull();
            boxes.include(0, low, high);
            boxes
        }));
        for a in 0..num_nodes {
            for b in a + 1..num_nodes {
                if self.hulls[a as usize].overlaps(&self.hulls[b as usize], 0) & 1 != 0 {
                    parts.push(NodePair { level, nodes: [a, b] });
                }
            }
        }
    }

    /// Calls `found` once for each pair of faces in this part whose boxes overlap.
    pub(crate) fn search(&self, part: NodePair, found: &mut impl FnMut(FaceId, FaceId)) {
        let NodePair { level, nodes: [a, b] } = part;
        let (first, second) = (&self.levels[level][a as usize], &self.levels[level][b as usize]);
        for slot in 0..WIDTH {
            let mut hits = second.overlaps(first, slot);
            if a == b {
                // Each pair once; a node with itself only above the leaves.
                hits &= u32::MAX << (slot + usize::from(level == 0));
            }
            while hits != 0 {
                let other = hits.trailing_zeros();
                hits &= hits - 1;
                let slot = u32::try_from(slot).expect("below 8");
                let children = [8 * a + slot, 8 * b + other];
                if level == 0 {
                    found(self.order[children[0] as usize], self.order[children[1] as usize]);
                } else {
                    self.search(NodePair { level: level - 1, nodes: children }, found);
                }
            }
        }
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
