//! A triangulation that gets coarser by half-edge collapses, the shortest edge first (Hoppe et al. 1993): a vertex is
//! moved into a neighbour, and all others stay where they are.

use std::{cmp::Reverse, collections::BinaryHeap};

use nalgebra::{Point3, Vector3};

use super::removed::RemovedVertex;
use crate::mesh::Mesh;

/// No face turns by an angle with a smaller cosine, 60 degrees.
const MIN_COSINE: f64 = 0.5;
/// Faces of less quality get no worse; 1 is that of an equilateral triangle.
const MIN_QUALITY: f64 = 0.4;
/// Boundary vertices where the boundary turns by an angle with a smaller cosine are corners, and stay.
const MIN_BOUNDARY_COSINE: f64 = 0.7;

/// An edge, by its squared length and its vertices: of numbers that are not negative the bits are in their order.
type Candidate = (u64, [u32; 2]);

/// A triangulation that gets coarser.
pub(super) struct Collapser<'a> {
    positions: &'a [Point3<f64>],
    faces: Vec<[u32; 3]>,
    /// The faces of each vertex that are left.
    vertex_faces: Vec<Vec<u32>>,
    /// Pinned vertices, and those of edges with more than two faces.
    is_fixed: Vec<bool>,
    is_boundary: Vec<bool>,
    candidates: BinaryHeap<Reverse<Candidate>>,
    removed: Vec<RemovedVertex>,
}

impl<'a> Collapser<'a> {
    pub(super) fn new(mesh: &Mesh, positions: &'a [Point3<f64>]) -> Self {
        let faces_of = |vertex| mesh.vertex_faces(vertex).iter().map(|face| face.0).collect();
        let mut collapser = Self {
            positions,
            faces: mesh.face_ids().map(|face| mesh.face(face).map(|corner| corner.0)).collect(),
            vertex_faces: mesh.vertex_ids().map(faces_of).collect(),
            is_fixed: mesh.vertex_ids().map(|vertex| mesh.is_pinned(vertex)).collect(),
            is_boundary: vec![false; mesh.num_vertices()],
            candidates: BinaryHeap::new(),
            removed: Vec::new(),
        };
        for edge in mesh.edge_ids() {
            let ends = mesh.edge(edge).map(|end| end.0);
            let num_faces = mesh.edge_faces(edge).len();
            for end in ends {
                collapser.is_boundary[end as usize] |= num_faces == 1;
                collapser.is_fixed[end as usize] |= num_faces > 2;
            }
            collapser.offer(ends);
        }
        collapser
    }

    /// Collapses edges until so many vertices are removed, or no more can be; gives back these, in their order.
    ///
    /// Cost: O(n log n).
    pub(super) fn remove(&mut self, num_vertices: usize) -> Vec<RemovedVertex> {
        while self.removed.len() < num_vertices
            && let Some(Reverse((_, [a, b]))) = self.candidates.pop()
        {
            if !self.collapse(a, b) {
                self.collapse(b, a);
            }
        }
        std::mem::take(&mut self.removed)
    }

    /// The faces that are left, in their order.
    pub(super) fn faces(&self) -> impl Iterator<Item = [u32; 3]> + '_ {
        let is_left = |(face, corners): &(u32, &[u32; 3])| self.vertex_faces[corners[0] as usize].contains(face);
        (0u32..).zip(&self.faces).filter(is_left).map(|(_, corners)| *corners)
    }

    fn offer(&mut self, [a, b]: [u32; 2]) {
        let length_squared_m2 = (self.position(a) - self.position(b)).norm_squared();
        self.candidates.push(Reverse((length_squared_m2.to_bits(), [a.min(b), a.max(b)])));
    }

    fn position(&self, vertex: u32) -> Point3<f64> {
        self.positions[vertex as usize]
    }

    fn faces_of(&self, vertex: u32) -> impl Iterator<Item = [u32; 3]> + Clone + '_ {
        self.vertex_faces[vertex as usize].iter().map(|&face| self.faces[face as usize])
    }

    /// The vertices that have an edge with one, in order.
    fn neighbours(&self, vertex: u32) -> Vec<u32> {
        let mut neighbours: Vec<u32> = self.faces_of(vertex).flatten().filter(|&corner| corner != vertex).collect();
        neighbours.sort_unstable();
        neighbours.dedup();
        neighbours
    }

    /// Moves a vertex into a neighbour. False where that may not be.
    fn collapse(&mut self, from: u32, into: u32) -> bool {
        if self.is_fixed[from as usize] || !self.is_topology_kept(from, into) {
            return false;
        }
        let staying = self.faces_of(from).filter(|face| !face.contains(&into));
        let moved: Vec<[u32; 3]> = staying.clone().map(|face| replaced(face, from, into)).collect();
        if !staying.zip(&moved).all(|(before, &after)| self.is_shape_kept(before, after)) {
            return false;
        }
        let Some(removed) = RemovedVertex::on_nearest(from, &moved, self.positions) else { return false };
        self.removed.push(removed);
        for face in std::mem::take(&mut self.vertex_faces[from as usize]) {
            let corners = self.faces[face as usize];
            if corners.contains(&into) {
                for corner in corners {
                    self.vertex_faces[corner as usize].retain(|&other| other != face);
                }
            } else {
                self.faces[face as usize] = replaced(corners, from, into);
                self.vertex_faces[into as usize].push(face);
            }
        }
        for neighbour in self.neighbours(into) {
            self.offer([into, neighbour]);
        }
        true
    }

    /// Whether the surface stays what it is where a vertex is moved into a neighbour (the link condition, Dey et al.
    /// 1999): both have the vertices opposite to their edge in common, and no others, and a boundary vertex moves along
    /// the boundary, which goes straight on there.
    fn is_topology_kept(&self, from: u32, into: u32) -> bool {
        let num_shared = self.faces_of(from).filter(|face| face.contains(&into)).count();
        let is_boundary = self.is_boundary[from as usize];
        if num_shared != if is_boundary { 1 } else { 2 } {
            return false;
        }
        let (around, others) = (self.neighbours(from), self.neighbours(into));
        let num_common = around.iter().filter(|vertex| others.binary_search(vertex).is_ok()).count();
        // Two triangles back to back, or four that close, have no vertex to spare.
        let is_last = others.len() <= num_common + 1 && !is_boundary;
        num_common == num_shared && !is_last && (!is_boundary || self.is_straight(from, into, &around))
    }

    /// Whether the boundary goes on in about the same direction at a vertex, seen from a neighbour.
    fn is_straight(&self, at: u32, from: u32, neighbours: &[u32]) -> bool {
        let num_faces = |other: u32| self.faces_of(at).filter(|face| face.contains(&other)).count();
        let Some(&to) = neighbours.iter().find(|&&other| other != from && num_faces(other) == 1) else { return false };
        let (before, after) = (self.position(at) - self.position(from), self.position(to) - self.position(at));
        before.dot(&after) >= MIN_BOUNDARY_COSINE * before.norm() * after.norm()
    }

    /// Whether a face keeps its direction, and is of good quality, or of no less than before.
    fn is_shape_kept(&self, before: [u32; 3], after: [u32; 3]) -> bool {
        let [(old, old_quality), (new, new_quality)] = [before, after].map(|corners| {
            let [a, b, c] = corners.map(|corner| self.position(corner));
            let normal: Vector3<f64> = (b - a).cross(&(c - a));
            let sides = (b - a).norm_squared() + (c - b).norm_squared() + (a - c).norm_squared();
            (normal, 12f64.sqrt() * normal.norm() / sides)
        });
        old.dot(&new) > MIN_COSINE * old.norm() * new.norm() && new_quality >= old_quality.min(MIN_QUALITY)
    }
}

fn replaced(face: [u32; 3], from: u32, into: u32) -> [u32; 3] {
    face.map(|corner| if corner == from { into } else { corner })
}
