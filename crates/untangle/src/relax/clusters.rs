//! Paths that lie close together, and how tangled each such cluster is.

use nalgebra::Point3;

use crate::{
    analysis::Analysis,
    frame::Frame,
    intersect::{Intersections, SegmentEnd},
    mesh::{FaceId, Mesh, VertexId},
};

const NONE: u32 = u32::MAX;

/// Rings of vertices round a path that belong to it.
const RINGS: usize = 2;

/// Clusters of paths, and for the vertices round them the cluster that is nearest.
#[derive(Clone, Debug, Default)]
pub(super) struct Clusters {
    label: Vec<u32>,
    touched: Vec<VertexId>,
    num_clusters: usize,
    parent: Vec<usize>,
}

impl Clusters {
    /// Joins the paths of a frame into clusters: paths are together if the vertices round them, or those inside of them, meet.
    /// Then hands the labels on over `reach` more rings.
    pub(super) fn find(&mut self, mesh: &Mesh, analysis: &Analysis, reach: usize) {
        for vertex in self.touched.drain(..) {
            self.label[vertex.index()] = NONE;
        }
        self.label.resize(mesh.num_vertices(), NONE);
        let copies = &analysis.paths.copies;
        self.parent.clear();
        self.parent.extend(0..copies.len());
        for (copy, path) in copies.iter().enumerate() {
            self.join(copy, path.partner);
            for segment in &analysis.paths.segments[path.segments.clone()] {
                for vertex in mesh.face(segment.own).into_iter().chain(mesh.face(segment.partner)) {
                    self.claim(vertex, copy);
                }
            }
            for &vertex in analysis.regions.vertices_of(copy) {
                self.claim(vertex, copy);
            }
        }
        let mut first = 0;
        for ring in 0..RINGS + reach {
            let last = self.touched.len();
            if first == last {
                break;
            }
            for slot in first..last {
                let vertex = self.touched[slot];
                let copy = self.label[vertex.index()] as usize;
                for &edge in mesh.vertex_edges(vertex) {
                    let next = mesh.opposite_vertex(edge, vertex);
                    if ring < RINGS {
                        self.claim(next, copy);
                    } else if self.label[next.index()] == NONE {
                        self.label[next.index()] = self.label[vertex.index()];
                        self.touched.push(next);
                    }
                }
            }
            first = last;
        }
        // From copies to clusters, numbered in the order of their lowest copy.
        let mut number = vec![NONE; copies.len()];
        self.num_clusters = 0;
        for copy in 0..copies.len() {
            let root = self.root(copy);
            if number[root] == NONE {
                number[root] = u32::try_from(self.num_clusters).expect("fewer clusters than paths");
                self.num_clusters += 1;
            }
            number[copy] = number[root];
        }
        for vertex in &self.touched {
            let label = &mut self.label[vertex.index()];
            *label = number[*label as usize];
        }
    }

    fn claim(&mut self, vertex: VertexId, copy: usize) {
        let label = self.label[vertex.index()];
        if label == NONE {
            self.label[vertex.index()] = u32::try_from(copy).expect("fewer paths than faces");
            self.touched.push(vertex);
        } else {
            self.join(label as usize, copy);
        }
    }

    fn root(&mut self, copy: usize) -> usize {
        let mut root = copy;
        while self.parent[root] != root {
            self.parent[root] = self.parent[self.parent[root]];
            root = self.parent[root];
        }
        root
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        let (low, high) = (a.min(b), a.max(b));
        self.parent[high] = low;
    }

    pub(super) fn len(&self) -> usize {
        self.num_clusters
    }

    /// The cluster of a vertex, if there is one near.
    pub(super) fn of(&self, vertex: VertexId) -> Option<usize> {
        self.label.get(vertex.index()).filter(|&&label| label != NONE).map(|&label| label as usize)
    }
}

/// How tangled something is: less is better.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Tangle {
    pub(super) num_edge_face: usize,
    /// Length of the intersections, in edges of the faces that intersect.
    pub(super) length_edges: f64,
    pub(super) length_m: f64,
}

impl Tangle {
    /// Whether nothing intersects.
    pub(super) fn is_none(&self) -> bool {
        self.num_edge_face == 0
    }

    /// One number to compare by.
    pub(super) fn merit(&self) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "a count")]
        let count = self.num_edge_face as f64;
        count + 2.0 * self.length_edges
    }
}

/// Measures all intersections, cluster by cluster; the last entry is for those near no cluster.
pub(super) fn measure(
    mesh: &Mesh,
    frame: &Frame,
    found: &Intersections,
    clusters: &Clusters,
    tangles: &mut Vec<Tangle>,
) {
    tangles.clear();
    tangles.resize(clusters.len() + 1, Tangle::default());
    let place =
        |face: FaceId| mesh.face(face).into_iter().find_map(|vertex| clusters.of(vertex)).unwrap_or(clusters.len());
    for crossing in &found.edge_face {
        tangles[place(crossing.face)].num_edge_face += 1;
    }
    for segment in &found.segments {
        let [a, b] = segment.ends.map(|end| position(frame, found, end));
        let length = (b - a).norm();
        let edges = segment.faces.map(|face| edge_length(mesh, frame, face));
        let tangle = &mut tangles[place(segment.faces[0])];
        tangle.length_m += length;
        if edges[0] + edges[1] > 0.0 {
            tangle.length_edges += 2.0 * length / (edges[0] + edges[1]);
        }
    }
}

fn position(frame: &Frame, found: &Intersections, end: SegmentEnd) -> Point3<f64> {
    match end {
        SegmentEnd::EdgeFace(index) => found.edge_face[index as usize].position,
        SegmentEnd::LoopVertex(vertex) => frame.position(vertex),
    }
}

fn edge_length(mesh: &Mesh, frame: &Frame, face: FaceId) -> f64 {
    let [a, b, c] = mesh.face(face).map(|vertex| frame.position(vertex));
    ((b - a).norm() + (c - b).norm() + (a - c).norm()) / 3.0
}
