//! The two sheets round a contour: geodesic windows that can be as wide as needed.

use std::{cmp::Reverse, collections::BinaryHeap};

use super::contour::Contour;
use crate::{
    frame::Frame,
    mesh::{FaceId, Mesh, VertexId},
    sparse_map::SparseMap,
};

/// The faces of both sheets within a distance from a contour. A face that is near both copies belongs to the nearer.
#[derive(Debug, Default)]
pub(super) struct Sheets {
    /// Faces of the first and of the second sheet.
    pub(super) faces: [Vec<FaceId>; 2],
    /// Vertices of the first and of the second sheet.
    pub(super) vertices: [Vec<VertexId>; 2],
    reached: SparseMap<VertexId, u8>,
    labels: SparseMap<FaceId, u8>,
    /// Distances as bits, which sort as the distances do.
    queue: BinaryHeap<Reverse<(u64, VertexId, u8)>>,
}

impl Sheets {
    /// Takes the faces with a vertex within `radius_m` of the contour, along edges, but no more than about `max_faces`.
    /// False where these were not enough.
    pub(super) fn grow(
        &mut self,
        mesh: &Mesh,
        frame: &Frame,
        contour: &Contour,
        radius_m: f64,
        max_faces: usize,
    ) -> bool {
        self.begin(mesh, contour);
        let mut num_reached = 0;
        while let Some(Reverse((bits, vertex, sheet))) = self.queue.pop() {
            if !self.reached.insert(vertex, sheet) {
                continue;
            }
            num_reached += 1;
            if 2 * num_reached > max_faces {
                return false;
            }
            self.vertices[usize::from(sheet)].push(vertex);
            for &face in mesh.vertex_faces(vertex) {
                if self.labels.insert(face, sheet) {
                    self.faces[usize::from(sheet)].push(face);
                }
            }
            let distance = f64::from_bits(bits);
            for &edge in mesh.vertex_edges(vertex) {
                let next = mesh.opposite_vertex(edge, vertex);
                let further = distance + (frame.position(next) - frame.position(vertex)).norm();
                if further <= radius_m && !self.reached.contains(next) {
                    self.queue.push(Reverse((further.to_bits(), next, sheet)));
                }
            }
        }
        true
    }

    /// Whether an edge leads from one window to the other.
    pub(super) fn meet(&self, mesh: &Mesh) -> bool {
        let leads_over = |vertex: VertexId| {
            let mut neighbours = mesh.vertex_edges(vertex).iter().map(|&edge| mesh.opposite_vertex(edge, vertex));
            neighbours.any(|next| self.reached.get(next) == Some(1))
        };
        self.vertices[0].iter().any(|&vertex| leads_over(vertex))
    }

    /// Begins with the faces along the contour and their corners.
    fn begin(&mut self, mesh: &Mesh, contour: &Contour) {
        self.reached.reset(mesh.num_vertices());
        self.labels.reset(mesh.num_faces());
        self.queue.clear();
        self.faces.iter_mut().for_each(Vec::clear);
        self.vertices.iter_mut().for_each(Vec::clear);
        for segment in &contour.segments {
            for (face, sheet) in segment.faces.into_iter().zip([0, 1]) {
                if self.labels.insert(face, sheet) {
                    self.faces[usize::from(sheet)].push(face);
                }
                let seeds = mesh.face(face).into_iter().map(|vertex| Reverse((0.0f64.to_bits(), vertex, sheet)));
                self.queue.extend(seeds);
            }
        }
    }
}
