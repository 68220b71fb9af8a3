//! The vertices and edges of each leaf of the tree, each in the first leaf that has it, so that no pair is tested
//! twice.

use rayon::prelude::*;

use crate::{
    intersect::{Aabb, AabbX8, Bvh, PointF32, WIDTH},
    mesh::{EdgeId, Mesh, VertexId},
};

/// Least number of leaves that one thread takes at a time.
const MIN_LEAVES_PER_TASK: usize = 256;

/// An edge with its ends.
pub(super) type Edge = (EdgeId, [VertexId; 2]);

/// What a leaf owns.
#[derive(Debug, Default)]
pub(super) struct Elements {
    vertices: Vec<VertexId>,
    vertex_ends: Vec<usize>,
    edges: Vec<Edge>,
    edge_ends: Vec<usize>,
    /// Boxes of the edges, eight by eight, those of each leaf on their own.
    boxes: Vec<[AabbX8; EDGE_CHUNKS]>,
}

/// A leaf has eight faces, of three edges each.
const EDGE_CHUNKS: usize = 3;

impl Elements {
    /// Shares out the vertices and edges of a mesh.
    ///
    /// Cost: linear in the faces.
    pub(super) fn new(mesh: &Mesh, bvh: &Bvh) -> Self {
        let (mut has_vertex, mut has_edge) = (vec![false; mesh.num_vertices()], vec![false; mesh.num_edges()]);
        let mut elements = Self::default();
        for leaf in bvh.faces().chunks(WIDTH) {
            for &face in leaf {
                let is_new = |vertex: &VertexId| !std::mem::replace(&mut has_vertex[vertex.0 as usize], true);
                elements.vertices.extend(mesh.face(face).into_iter().filter(is_new));
                let is_new = |edge: &EdgeId| !std::mem::replace(&mut has_edge[edge.0 as usize], true);
                let edges = mesh.face_edges(face).into_iter().flatten().filter(is_new);
                elements.edges.extend(edges.map(|edge| (edge, mesh.edge(edge))));
            }
            elements.vertex_ends.push(elements.vertices.len());
            elements.edge_ends.push(elements.edges.len());
        }
        elements.boxes.resize(elements.edge_ends.len(), [AabbX8::EMPTY; EDGE_CHUNKS]);
        elements
    }

    /// Fits the boxes of edges to the points of the tree.
    ///
    /// Cost: linear in the edges, in parallel.
    pub(super) fn refit(&mut self, points: &[PointF32]) {
        let Self { edges, edge_ends, boxes, .. } = self;
        boxes.par_iter_mut().with_min_len(MIN_LEAVES_PER_TASK).enumerate().for_each(|(leaf, boxes)| {
            for (index, (_, ends)) in row(edges, edge_ends, leaf).iter().enumerate() {
                boxes[index / WIDTH].set(index % WIDTH, bounds(points, ends));
            }
        });
    }

    /// The vertices of a leaf.
    pub(super) fn vertices(&self, leaf: u32) -> &[VertexId] {
        row(&self.vertices, &self.vertex_ends, leaf as usize)
    }

    /// The edges of a leaf, and their boxes in the same order.
    pub(super) fn edges(&self, leaf: u32) -> (&[Edge], &[AabbX8]) {
        let edges = row(&self.edges, &self.edge_ends, leaf as usize);
        (edges, &self.boxes[leaf as usize][..edges.len().div_ceil(WIDTH)])
    }
}

fn row<'a, T>(all: &'a [T], ends: &[usize], index: usize) -> &'a [T] {
    let start = if index == 0 { 0 } else { ends[index - 1] };
    &all[start..ends[index]]
}

/// The box round some vertices.
#[inline(always)]
pub(super) fn bounds<const N: usize>(points: &[PointF32], vertices: &[VertexId; N]) -> Aabb {
    let (first, last) = (&points[vertices[0].0 as usize], &points[vertices[N - 1].0 as usize]);
    Aabb::of_triangle([first, last, last])
}
