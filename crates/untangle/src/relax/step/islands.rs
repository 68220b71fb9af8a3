//! Islands of coupled contours: intersection paths (contours) so close together that they are resolved together.

use crate::{
    analysis::Analysis,
    mesh::{Mesh, VertexId},
    sparse_map::SparseMap,
};

/// Paths with a common vertex in their k-rings of this width are coupled.
const ISLAND_RINGS: usize = 2;

/// Islands of paths, and for the vertices round them the island that is nearest.
#[derive(Clone, Debug, Default)]
pub(crate) struct Islands {
    /// The island of a vertex. While islands are looked for: a copy of a path of that island, or after all copies a
    /// vertex inside of a body.
    labels: SparseMap<VertexId, u32>,
    num_islands: usize,
    /// Disjoint sets of copies and vertices inside of bodies: the parent of each, or itself.
    parents: Vec<usize>,
    /// The number of each root.
    numbers: Vec<Option<u32>>,
}

impl Islands {
    /// Joins the paths of a frame into islands: paths are coupled if the vertices round them, or those inside of them,
    /// meet. `wrong` are vertices on the wrong side, each with what it is behind, coupled in the same way, with or
    /// without a path. Then extends the labels over the `reach`-ring round them.
    ///
    /// Cost: linear in the vertices that are reached.
    pub(crate) fn find(&mut self, mesh: &Mesh, analysis: &Analysis, wrong: &[Vec<VertexId>], reach: usize) {
        self.labels.reset(mesh.num_vertices());
        let num_copies = analysis.paths.copies.len();
        self.parents.clear();
        self.parents.extend(0..num_copies + wrong.len());
        self.label_paths(mesh, analysis);
        for (index, group) in wrong.iter().enumerate() {
            group.iter().for_each(|&vertex| self.claim(vertex, num_copies + index));
        }
        let mut first = 0;
        for ring in 0..ISLAND_RINGS + reach {
            let last = self.labels.keys().len();
            if first == last {
                break;
            }
            for index in first..last {
                self.label_neighbours(mesh, self.labels.keys()[index], ring < ISLAND_RINGS);
            }
            first = last;
        }
        self.number_islands(num_copies + wrong.len());
    }

    /// Labels the corners of all faces along a path, and the vertices inside of it, with its copy.
    fn label_paths(&mut self, mesh: &Mesh, analysis: &Analysis) {
        let copies = &analysis.paths.copies;
        for (copy, path) in copies.iter().enumerate() {
            self.join(copy, path.partner);
            for segment in &analysis.paths.segments[path.segments.clone()] {
                // What meets one body is not coupled by it: the body does not move.
                for face in [segment.own, segment.partner].into_iter().filter(|&face| !mesh.is_body_face(face)) {
                    for vertex in mesh.face(face) {
                        self.claim(vertex, copy);
                    }
                }
            }
            for &vertex in analysis.regions.vertices_of(copy).iter().filter(|&&vertex| !mesh.is_body(vertex)) {
                self.claim(vertex, copy);
            }
        }
    }

    /// Gives the neighbours of a vertex its label, unless they have one; sets of copies that meet here are joined if
    /// asked for.
    fn label_neighbours(&mut self, mesh: &Mesh, vertex: VertexId, joins: bool) {
        let Some(label) = self.labels.get(vertex) else { return };
        for &edge in mesh.vertex_edges(vertex) {
            let next = mesh.opposite_vertex(edge, vertex);
            if joins {
                self.claim(next, label as usize);
            } else {
                self.labels.insert(next, label);
            }
        }
    }

    /// Replaces copies by islands, numbered in the order of their lowest copy.
    fn number_islands(&mut self, num_copies: usize) {
        self.numbers.clear();
        self.numbers.resize(num_copies, None);
        let mut next = 0;
        for copy in 0..num_copies {
            let root = self.root(copy);
            let number = *self.numbers[root].get_or_insert_with(|| {
                next += 1;
                next - 1
            });
            self.numbers[copy] = Some(number);
        }
        self.num_islands = next as usize;
        for index in 0..self.labels.keys().len() {
            let label = self.labels.entry(self.labels.keys()[index]);
            *label = self.numbers[*label as usize].expect("each copy of a path is in an island");
        }
    }

    /// Labels a vertex with a copy, or joins the copy with the one that was here before.
    fn claim(&mut self, vertex: VertexId, copy: usize) {
        match self.labels.get(vertex) {
            Some(label) => self.join(label as usize, copy),
            None => {
                self.labels.set(vertex, u32::try_from(copy).expect("fewer paths than faces, and fewer than vertices"))
            }
        }
    }

    fn root(&mut self, copy: usize) -> usize {
        let mut root = copy;
        while self.parents[root] != root {
            self.parents[root] = self.parents[self.parents[root]];
            root = self.parents[root];
        }
        root
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        let (low, high) = (a.min(b), a.max(b));
        self.parents[high] = low;
    }

    /// The number of islands.
    pub(crate) fn len(&self) -> usize {
        self.num_islands
    }

    /// The island of a vertex; for one that lies near none, one past the last.
    pub(crate) fn of(&self, vertex: VertexId) -> usize {
        self.near(vertex).unwrap_or(self.num_islands)
    }

    /// The island of a vertex, if there is one near.
    pub(crate) fn near(&self, vertex: VertexId) -> Option<usize> {
        // Before the first search there is not even a table.
        if self.num_islands == 0 { None } else { self.labels.get(vertex).map(|label| label as usize) }
    }
}
