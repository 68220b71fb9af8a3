//! Parallel flood fill: colours the vertices on both sides of a path at once and stops as soon as the smaller side is done.
//!
//! Two vertices joined by an edge that the path crosses an odd number of times lie on different sides, all other neighbours on
//! the same side. The fill ends when one side has no neighbour left to visit and every crossed edge has been seen; then that side is
//! closed, every crossed edge has exactly one end in it, and no odd cycle can exist anywhere: the path separates, although most of the larger side
//! was never visited. The cost grows with the smaller side.

use std::collections::VecDeque;

use crate::mesh::{EdgeId, Mesh, VertexId};

/// What a fill found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Separation {
    /// The path does not divide the vertices in two.
    None,
    /// It does; the smaller side is complete in [`Flood::smaller`].
    Two,
}

/// What a fill asks about vertices and edges.
pub(crate) struct Terms<'a> {
    /// Whether a vertex belongs to the part of the cloth that is to be divided.
    pub(crate) allowed: &'a dyn Fn(VertexId) -> bool,
    /// How much a vertex counts: the smaller side has less of it.
    pub(crate) weight: &'a dyn Fn(VertexId) -> f64,
    /// What decides where both sides weigh exactly the same.
    pub(crate) tie_weight: &'a dyn Fn(VertexId) -> f64,
    /// The end of a crossed edge to the left of the path, if that is known: what tells the sides of parts of the path from each other
    /// that no way inside the allowed part connects.
    pub(crate) left: &'a dyn Fn(EdgeId) -> Option<VertexId>,
}

/// Memory of the fill; nothing is cleared between fills, a new epoch makes old marks void.
#[derive(Debug, Default)]
pub(crate) struct Flood {
    epoch: u32,
    /// Epoch and side of the last colouring of each vertex.
    colour: Vec<(u32, u8)>,
    /// Epoch in which each edge was last crossed, and whether the fill has seen it.
    crossed: Vec<(u32, bool)>,
    /// Epoch in which each vertex was last taken out.
    removed: Vec<u32>,
    queues: [VecDeque<VertexId>; 2],
    sides: [Vec<VertexId>; 2],
    smaller: usize,
    odd_edges: Vec<EdgeId>,
}

impl Flood {
    /// Starts a fill: forgets crossed edges and removed vertices.
    pub(crate) fn begin(&mut self, mesh: &Mesh) {
        self.colour.resize(mesh.num_vertices(), (0, 0));
        self.removed.resize(mesh.num_vertices(), 0);
        self.crossed.resize(mesh.num_edges(), (0, false));
        self.epoch = self.epoch.checked_add(1).unwrap_or_else(|| {
            self.colour.fill((0, 0));
            self.removed.fill(0);
            self.crossed.fill((0, false));
            1
        });
        self.odd_edges.clear();
    }

    /// The path crosses this edge once more.
    pub(crate) fn cross(&mut self, edge: EdgeId) {
        let slot = &mut self.crossed[edge.index()];
        if slot.0 == self.epoch {
            slot.0 = 0;
        } else {
            *slot = (self.epoch, false);
            self.odd_edges.push(edge);
        }
    }

    /// Takes a vertex out, with all its edges.
    pub(crate) fn remove(&mut self, vertex: VertexId) {
        self.removed[vertex.index()] = self.epoch;
    }

    fn is_crossed(&self, edge: EdgeId) -> bool {
        self.crossed[edge.index()].0 == self.epoch
    }

    /// Fills both sides.
    pub(crate) fn fill(&mut self, mesh: &Mesh, terms: &Terms<'_>) -> Separation {
        for side in 0..2 {
            self.queues[side].clear();
            self.sides[side].clear();
        }
        self.smaller = 0;
        let separation = self.fill_open(mesh, terms);
        if separation == Separation::Two {
            self.smaller = self.choose_smaller(terms);
            self.sides[self.smaller].sort_unstable();
        }
        separation
    }

    fn is_open(&self, vertex: VertexId, terms: &Terms<'_>) -> bool {
        self.removed[vertex.index()] != self.epoch && (terms.allowed)(vertex)
    }

    fn fill_open(&mut self, mesh: &Mesh, terms: &Terms<'_>) -> Separation {
        // An edge crossed an even number of times was pushed once for each odd count on the way.
        let mut odd_edges = std::mem::take(&mut self.odd_edges);
        odd_edges.sort_unstable();
        odd_edges.dedup();
        odd_edges.retain(|&edge| {
            self.is_crossed(edge) && mesh.edge(edge).into_iter().all(|vertex| self.is_open(vertex, terms))
        });
        let separation = self.fill_from(mesh, terms, &odd_edges);
        self.odd_edges = odd_edges;
        separation
    }

    fn fill_from(&mut self, mesh: &Mesh, terms: &Terms<'_>, odd_edges: &[EdgeId]) -> Separation {
        let Some(&seed) = odd_edges.first() else {
            // Nothing to tell apart: a region without vertices.
            return Separation::Two;
        };
        let mut unseen = odd_edges.len();
        let mut weights = [0.0; 2];
        for (side, vertex) in mesh.edge(seed).into_iter().enumerate() {
            self.push(side, vertex);
            weights[side] += (terms.weight)(vertex);
        }
        let left_side = (terms.left)(seed).map(|left| usize::from(mesh.edge(seed)[1] == left));
        loop {
            let exhausted = [0, 1].map(|side: usize| self.queues[side].is_empty());
            let done = |side: usize| exhausted[side] && (exhausted[1 - side] || weights[1 - side] > weights[side]);
            if unseen == 0 && (done(0) || done(1)) {
                break;
            }
            if exhausted == [true; 2] {
                // A part of the path that no way inside the allowed vertices connects with the others.
                let next = odd_edges.iter().find(|edge| !self.crossed[edge.index()].1);
                let known = next.and_then(|&edge| Some((edge, (terms.left)(edge)?, left_side?)));
                let Some((edge, left, left_side)) = known else { return Separation::None };
                for vertex in mesh.edge(edge) {
                    let side = if vertex == left { left_side } else { 1 - left_side };
                    self.push(side, vertex);
                    weights[side] += (terms.weight)(vertex);
                }
                continue;
            }
            let side = if exhausted[0] || (!exhausted[1] && weights[1] < weights[0]) { 1 } else { 0 };
            let Some(vertex) = self.queues[side].pop_front() else { unreachable!("not both are exhausted") };
            for &edge in mesh.vertex_edges(vertex) {
                let neighbour = mesh.opposite_vertex(edge, vertex);
                if !self.is_open(neighbour, terms) {
                    continue;
                }
                let across = self.is_crossed(edge);
                if across && !std::mem::replace(&mut self.crossed[edge.index()].1, true) {
                    unseen -= 1;
                }
                let wanted = if across { 1 - side } else { side };
                match self.side_of(neighbour) {
                    Some(found) if found != wanted => return Separation::None,
                    Some(_) => {}
                    None => {
                        self.push(wanted, neighbour);
                        weights[wanted] += (terms.weight)(neighbour);
                    }
                }
            }
        }
        Separation::Two
    }

    /// Goes on until the other side is complete too. To be called only after a fill that separated: then no conflict can
    /// come up any more.
    pub(crate) fn complete(&mut self, mesh: &Mesh, terms: &Terms<'_>) {
        for side in 0..2 {
            while let Some(vertex) = self.queues[side].pop_front() {
                for &edge in mesh.vertex_edges(vertex) {
                    let neighbour = mesh.opposite_vertex(edge, vertex);
                    if self.is_open(neighbour, terms) && self.side_of(neighbour).is_none() {
                        let wanted = if self.is_crossed(edge) { 1 - side } else { side };
                        self.push(wanted, neighbour);
                    }
                }
            }
        }
        self.sides.iter_mut().for_each(|side| side.sort_unstable());
    }

    fn choose_smaller(&self, terms: &Terms<'_>) -> usize {
        let total = |side: usize, weight: &dyn Fn(VertexId) -> f64| -> f64 {
            self.sides[side].iter().map(|&vertex| weight(vertex)).sum()
        };
        let lowest = |side: usize| self.sides[side].iter().min();
        let order = total(0, terms.weight).total_cmp(&total(1, terms.weight));
        // The fill ran to the end of both sides if they weigh the same.
        let order = order.then_with(|| total(0, terms.tie_weight).total_cmp(&total(1, terms.tie_weight)));
        usize::from(order.then_with(|| lowest(0).cmp(&lowest(1))).is_gt())
    }

    fn push(&mut self, side: usize, vertex: VertexId) {
        self.colour[vertex.index()] = (self.epoch, u8::from(side == 1));
        self.queues[side].push_back(vertex);
        self.sides[side].push(vertex);
    }

    /// The side on which a vertex was found, if it was visited.
    pub(crate) fn side_of(&self, vertex: VertexId) -> Option<usize> {
        let (epoch, side) = self.colour[vertex.index()];
        (epoch == self.epoch).then_some(usize::from(side))
    }

    /// Which side is the smaller one, after a fill that separated. Its vertices are all known.
    pub(crate) fn smaller(&self) -> usize {
        self.smaller
    }

    /// The vertices found on one side; ascending for the smaller side, and for both after [`complete`](Self::complete).
    pub(crate) fn side(&self, side: usize) -> &[VertexId] {
        &self.sides[side]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::MeshDescription;

    const ALL: Terms<'_> = Terms { allowed: &|_| true, weight: &|_| 1.0, tie_weight: &|_| 0.0, left: &|_| None };

    /// A strip of `n` quads, two vertices a column.
    fn strip(n: u32) -> Mesh {
        let faces = (0..n).flat_map(|i| [[2 * i, 2 * i + 1, 2 * i + 2], [2 * i + 2, 2 * i + 1, 2 * i + 3]]).collect();
        Mesh::new(MeshDescription { num_vertices: 2 * n as usize + 2, faces, ..Default::default() }).unwrap()
    }

    fn edge(mesh: &Mesh, a: u32, b: u32) -> EdgeId {
        mesh.edge_between(VertexId(a), VertexId(b)).unwrap()
    }

    #[test]
    fn the_smaller_side_of_a_cut_strip() {
        let mesh = strip(50);
        let mut flood = Flood::default();
        flood.begin(&mesh);
        for (a, b) in [(4, 6), (5, 6), (5, 7)] {
            flood.cross(edge(&mesh, a, b));
        }
        assert_eq!(flood.fill(&mesh, &ALL), Separation::Two);
        assert_eq!(flood.side(flood.smaller()), [0, 1, 2, 3, 4, 5].map(VertexId));
        // The larger side was left alone.
        assert!(flood.sides[1 - flood.smaller].len() < 16);
    }

    #[test]
    fn an_edge_crossed_twice_is_not_crossed() {
        let mesh = strip(4);
        let mut flood = Flood::default();
        flood.begin(&mesh);
        for _ in 0..2 {
            flood.cross(edge(&mesh, 4, 6));
        }
        assert_eq!(flood.fill(&mesh, &ALL), Separation::Two);
        assert!(flood.side(flood.smaller()).is_empty());
        flood.begin(&mesh);
        for _ in 0..3 {
            flood.cross(edge(&mesh, 4, 6));
        }
        // One edge alone does not separate.
        assert_eq!(flood.fill(&mesh, &ALL), Separation::None);
    }

    #[test]
    fn removed_vertices_do_not_carry_colour() {
        let mesh = strip(4);
        let mut flood = Flood::default();
        flood.begin(&mesh);
        flood.remove(VertexId(4));
        flood.cross(edge(&mesh, 5, 7));
        flood.cross(edge(&mesh, 5, 6));
        assert_eq!(flood.fill(&mesh, &ALL), Separation::Two);
        assert_eq!(flood.side(flood.smaller()), [6, 7, 8, 9].map(VertexId));
    }
}
