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
    /// Crossed edges, each with its end on the left of the path.
    odd_edges: Vec<(EdgeId, VertexId)>,
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

    /// The path crosses this edge once more, with the end `left` on its left.
    pub(crate) fn cross(&mut self, edge: EdgeId, left: VertexId) {
        let slot = &mut self.crossed[edge.index()];
        if slot.0 == self.epoch {
            slot.0 = 0;
        } else {
            *slot = (self.epoch, false);
            self.odd_edges.push((edge, left));
        }
    }

    /// Takes a vertex out, with all its edges.
    pub(crate) fn remove(&mut self, vertex: VertexId) {
        self.removed[vertex.index()] = self.epoch;
    }

    fn is_crossed(&self, edge: EdgeId) -> bool {
        self.crossed[edge.index()].0 == self.epoch
    }

    /// Fills both sides, restricted to vertices for which `allowed` holds. The smaller side has less `weight`; where both weigh
    /// exactly the same, less `tie_weight`.
    pub(crate) fn fill(
        &mut self,
        mesh: &Mesh,
        allowed: impl Fn(VertexId) -> bool,
        weight: impl Fn(VertexId) -> f64,
        tie_weight: impl Fn(VertexId) -> f64,
    ) -> Separation {
        for side in 0..2 {
            self.queues[side].clear();
            self.sides[side].clear();
        }
        self.smaller = 0;
        let removed = std::mem::take(&mut self.removed);
        let epoch = self.epoch;
        let open = |vertex: VertexId| removed[vertex.index()] != epoch && allowed(vertex);
        let separation = self.fill_open(mesh, &open, &weight);
        self.removed = removed;
        if separation == Separation::Two {
            self.smaller = self.choose_smaller(&weight, &tie_weight);
            self.sides[self.smaller].sort_unstable();
        }
        separation
    }

    fn fill_open(
        &mut self,
        mesh: &Mesh,
        open: &impl Fn(VertexId) -> bool,
        weight: &impl Fn(VertexId) -> f64,
    ) -> Separation {
        // An edge crossed an even number of times was pushed once for each odd count on the way.
        self.odd_edges.sort_unstable();
        self.odd_edges.dedup_by_key(|(edge, _)| *edge);
        let (epoch, crossed) = (self.epoch, &self.crossed);
        self.odd_edges.retain(|(edge, _)| crossed[edge.index()].0 == epoch && mesh.edge(*edge).into_iter().all(open));
        let mut unseen = self.odd_edges.len();
        let mut weights = [0.0; 2];
        let mut seeds = 0;
        loop {
            let exhausted = [0, 1].map(|side: usize| self.queues[side].is_empty());
            let done = |side: usize| exhausted[side] && (exhausted[1 - side] || weights[1 - side] > weights[side]);
            if unseen == 0 && (done(0) || done(1)) {
                break;
            }
            if exhausted == [true; 2] {
                // The first part, or another one that no way over allowed vertices connects with those before, as in a small disc
                // whose centre is taken out: what is left of the path stays left of it.
                let (edge, left) = self.odd_edges[seeds];
                seeds += 1;
                if !self.crossed[edge.index()].1 {
                    for (side, vertex) in [left, mesh.opposite_vertex(edge, left)].into_iter().enumerate() {
                        self.push(side, vertex);
                        weights[side] += weight(vertex);
                    }
                }
                continue;
            }
            let side = if exhausted[0] || (!exhausted[1] && weights[1] < weights[0]) { 1 } else { 0 };
            let Some(vertex) = self.queues[side].pop_front() else { unreachable!("not both are exhausted") };
            for &edge in mesh.vertex_edges(vertex) {
                let neighbour = mesh.opposite_vertex(edge, vertex);
                if !open(neighbour) {
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
                        weights[wanted] += weight(neighbour);
                    }
                }
            }
        }
        Separation::Two
    }

    /// Goes on until the other side is complete too. To be called only after a fill that separated: then no conflict can
    /// come up any more.
    pub(crate) fn complete(&mut self, mesh: &Mesh, allowed: impl Fn(VertexId) -> bool) {
        for side in 0..2 {
            while let Some(vertex) = self.queues[side].pop_front() {
                for &edge in mesh.vertex_edges(vertex) {
                    let neighbour = mesh.opposite_vertex(edge, vertex);
                    let open = self.removed[neighbour.index()] != self.epoch && allowed(neighbour);
                    if open && self.side_of(neighbour).is_none() {
                        let wanted = if self.is_crossed(edge) { 1 - side } else { side };
                        self.push(wanted, neighbour);
                    }
                }
            }
        }
        self.sides.iter_mut().for_each(|side| side.sort_unstable());
    }

    fn choose_smaller(&self, weight: &impl Fn(VertexId) -> f64, tie_weight: &impl Fn(VertexId) -> f64) -> usize {
        let total = |side: usize, weight: &dyn Fn(VertexId) -> f64| -> f64 {
            self.sides[side].iter().map(|&vertex| weight(vertex)).sum()
        };
        let lowest = |side: usize| self.sides[side].iter().min();
        let order = total(0, weight).total_cmp(&total(1, weight));
        // The fill ran to the end of both sides if they weigh the same.
        let order = order.then_with(|| total(0, tie_weight).total_cmp(&total(1, tie_weight)));
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
            flood.cross(edge(&mesh, a, b), VertexId(a));
        }
        assert_eq!(flood.fill(&mesh, |_| true, |_| 1.0, |_| 0.0), Separation::Two);
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
            flood.cross(edge(&mesh, 4, 6), VertexId(4));
        }
        assert_eq!(flood.fill(&mesh, |_| true, |_| 1.0, |_| 0.0), Separation::Two);
        assert!(flood.side(flood.smaller()).is_empty());
        flood.begin(&mesh);
        for _ in 0..3 {
            flood.cross(edge(&mesh, 4, 6), VertexId(4));
        }
        // One edge alone does not separate.
        assert_eq!(flood.fill(&mesh, |_| true, |_| 1.0, |_| 0.0), Separation::None);
    }

    #[test]
    fn removed_vertices_do_not_carry_colour() {
        let mesh = strip(4);
        let mut flood = Flood::default();
        flood.begin(&mesh);
        flood.remove(VertexId(4));
        flood.cross(edge(&mesh, 5, 7), VertexId(5));
        flood.cross(edge(&mesh, 5, 6), VertexId(5));
        assert_eq!(flood.fill(&mesh, |_| true, |_| 1.0, |_| 0.0), Separation::Two);
        assert_eq!(flood.side(flood.smaller()), [6, 7, 8, 9].map(VertexId));
    }

    #[test]
    fn parts_without_connection_are_told_apart_by_left_and_right() {
        let mesh = strip(8);
        let mut flood = Flood::default();
        flood.begin(&mesh);
        // Two ends of the strip, cut off from each other, one with its first vertex on the left, one with its second.
        for vertex in 6..12 {
            flood.remove(VertexId(vertex));
        }
        for (a, b, left) in [(0, 2, 2), (1, 2, 2), (1, 3, 3), (12, 14, 12), (13, 14, 13), (13, 15, 13)] {
            flood.cross(edge(&mesh, a, b), VertexId(left));
        }
        assert_eq!(flood.fill(&mesh, |_| true, |_| 1.0, |_| 0.0), Separation::Two);
        assert_eq!(flood.side(flood.smaller()), [0, 1, 14, 15, 16, 17].map(VertexId));
    }
}
