//! Parallel flood fill: colours the vertices on both sides of a path at once and stops as soon as the smaller side is
//! complete.
//!
//! Two vertices joined by an edge that the path crosses an odd number of times lie on different sides, all other
//! neighbours on the same side. The fill ends when one side has no neighbour left to visit and every crossed edge has
//! been seen; then that side is closed, every crossed edge has exactly one end in it, and no odd cycle can exist: the
//! path separates, although most of the larger side was never visited. The cost grows with the smaller side.

#[cfg(test)]
mod tests;

use std::collections::VecDeque;

use crate::{
    mesh::{EdgeId, Mesh, VertexId},
    sparse_map::SparseMap,
};

/// What a fill found: whether the path divides the vertices in two; the smaller side is complete in [`Flood::smaller`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Partition {
    Connected,
    TwoSides,
}

/// The rules of a fill: which vertices take part, and how both sides are compared.
pub(crate) struct FillRules<'a> {
    /// Whether a vertex belongs to the part of the cloth that is to be divided.
    pub(crate) allowed: &'a dyn Fn(VertexId) -> bool,
    /// The weight of a vertex: the side with the smaller sum is the smaller one.
    pub(crate) weight: &'a dyn Fn(VertexId) -> f64,
    /// Weights that decide where both sums are exactly the same.
    pub(crate) tie_weight: &'a dyn Fn(VertexId) -> f64,
    /// The end of a crossed edge to the left of the path, if that is known: it tells the sides apart on parts of the
    /// path that no edges between allowed vertices connect.
    pub(crate) left: &'a dyn Fn(EdgeId) -> Option<VertexId>,
}

/// An edge that the path crosses: whether an odd number of times, and whether the fill has come to it.
#[derive(Clone, Copy, Debug, Default)]
struct Crossing {
    is_odd: bool,
    is_seen: bool,
}

/// The state of a fill, reusing its memory from fill to fill.
#[derive(Debug, Default)]
pub(crate) struct Flood {
    /// The side of each vertex that was visited.
    colour: SparseMap<VertexId, u8>,
    crossings: SparseMap<EdgeId, Crossing>,
    removed: SparseMap<VertexId, ()>,
    queues: [VecDeque<VertexId>; 2],
    sides: [Vec<VertexId>; 2],
    /// Sums of the weights of both sides so far.
    weights: [f64; 2],
    smaller: usize,
    /// Edges that separate their ends, ascending.
    odd_edges: Vec<EdgeId>,
}

impl Flood {
    /// Clears crossed edges, removed vertices and both sides.
    pub(crate) fn reset(&mut self, mesh: &Mesh) {
        self.colour.reset(mesh.num_vertices());
        self.removed.reset(mesh.num_vertices());
        self.crossings.reset(mesh.num_edges());
    }

    /// The path crosses this edge once more.
    pub(crate) fn cross(&mut self, edge: EdgeId) {
        let crossing = self.crossings.entry(edge);
        crossing.is_odd = !crossing.is_odd;
    }

    /// Takes a vertex out, with all its edges.
    pub(crate) fn remove(&mut self, vertex: VertexId) {
        self.removed.set(vertex, ());
    }

    fn is_crossed(&self, edge: EdgeId) -> bool {
        self.crossings.get(edge).is_some_and(|crossing| crossing.is_odd)
    }

    /// Whether an edge leads to a vertex on the same side, after a fill that separated, reached by it or not.
    pub(crate) fn leads_to_same_side(&self, edge: EdgeId, neighbour: VertexId, rules: &FillRules<'_>) -> bool {
        !self.is_crossed(edge) && self.is_open(neighbour, rules)
    }

    /// Fills both sides.
    pub(crate) fn fill(&mut self, mesh: &Mesh, rules: &FillRules<'_>) -> Partition {
        for side in 0..2 {
            self.queues[side].clear();
            self.sides[side].clear();
        }
        self.weights = [0.0; 2];
        self.smaller = 0;
        let mut odd_edges = std::mem::take(&mut self.odd_edges);
        odd_edges.clear();
        odd_edges.extend(self.crossings.keys().iter().copied().filter(|&edge| {
            self.is_crossed(edge) && mesh.edge(edge).into_iter().all(|vertex| self.is_open(vertex, rules))
        }));
        odd_edges.sort_unstable();
        let partition = self.fill_from(mesh, rules, &odd_edges);
        self.odd_edges = odd_edges;
        if partition == Partition::TwoSides {
            self.smaller = self.choose_smaller(rules);
            self.sides[self.smaller].sort_unstable();
        }
        partition
    }

    /// Whether a vertex takes part in a fill.
    pub(crate) fn is_open(&self, vertex: VertexId, rules: &FillRules<'_>) -> bool {
        !self.removed.contains(vertex) && (rules.allowed)(vertex)
    }

    /// Fills from the first edge, on whose ends both sides begin, until one side is closed or a vertex would be on
    /// both.
    fn fill_from(&mut self, mesh: &Mesh, rules: &FillRules<'_>, odd_edges: &[EdgeId]) -> Partition {
        let Some(&seed) = odd_edges.first() else {
            // No edge separates anything: a region without vertices.
            return Partition::TwoSides;
        };
        let mut num_unseen = odd_edges.len();
        self.start_at(mesh, rules, seed, 0);
        let left_side = (rules.left)(seed).map(|left| usize::from(mesh.edge(seed)[1] == left));
        loop {
            let exhausted = [0, 1].map(|side: usize| self.queues[side].is_empty());
            let done =
                |side: usize| exhausted[side] && (exhausted[1 - side] || self.weights[1 - side] > self.weights[side]);
            if num_unseen == 0 && (done(0) || done(1)) {
                return Partition::TwoSides;
            }
            if exhausted == [true; 2] {
                // A part of the path is left that no edges between allowed vertices connect with the others.
                let unseen = odd_edges.iter().find(|&&edge| !self.is_seen(edge));
                let known = unseen.and_then(|&edge| Some((edge, (rules.left)(edge)?, left_side?)));
                let Some((edge, left, left_side)) = known else { return Partition::Connected };
                let first_side = if mesh.edge(edge)[0] == left { left_side } else { 1 - left_side };
                self.start_at(mesh, rules, edge, first_side);
                continue;
            }
            let side = if exhausted[0] || (!exhausted[1] && self.weights[1] < self.weights[0]) { 1 } else { 0 };
            let Some(vertex) = self.queues[side].pop_front() else {
                unreachable!("side {side} of the fill from {seed:?} is not exhausted, but has no vertex to visit")
            };
            let Some(num_seen) = self.visit(mesh, rules, side, vertex) else { return Partition::Connected };
            num_unseen -= num_seen;
        }
    }

    /// Begins both sides at the ends of a crossed edge: the first end on `first_side`, the second on the other one.
    fn start_at(&mut self, mesh: &Mesh, rules: &FillRules<'_>, edge: EdgeId, first_side: usize) {
        let [first, second] = mesh.edge(edge);
        self.push_weighed(rules, first_side, first);
        self.push_weighed(rules, 1 - first_side, second);
    }

    /// Colours the neighbours of a vertex. Returns the number of crossed edges seen for the first time; nothing if a
    /// neighbour would be on both sides.
    fn visit(&mut self, mesh: &Mesh, rules: &FillRules<'_>, side: usize, vertex: VertexId) -> Option<usize> {
        let mut num_seen = 0;
        for &edge in mesh.vertex_edges(vertex) {
            let neighbour = mesh.opposite_vertex(edge, vertex);
            if !self.is_open(neighbour, rules) {
                continue;
            }
            let is_across = self.is_crossed(edge);
            if is_across && !std::mem::replace(&mut self.crossings.entry(edge).is_seen, true) {
                num_seen += 1;
            }
            let wanted = if is_across { 1 - side } else { side };
            match self.side_of(neighbour) {
                Some(found) if found != wanted => return None,
                Some(_) => {}
                None => self.push_weighed(rules, wanted, neighbour),
            }
        }
        Some(num_seen)
    }

    fn is_seen(&self, edge: EdgeId) -> bool {
        self.crossings.get(edge).is_some_and(|crossing| crossing.is_seen)
    }

    /// Continues until the other side is complete too. To be called only after a fill that separated: from then on no
    /// vertex can come to be on both sides.
    pub(crate) fn complete(&mut self, mesh: &Mesh, rules: &FillRules<'_>) {
        for side in 0..2 {
            while self.advance(mesh, rules, side) {}
        }
        self.sides.iter_mut().for_each(|side| side.sort_unstable());
    }

    /// Continues until some vertices are known, as far as they can be reached. To be called only after a fill that
    /// separated.
    ///
    /// Cost: linear in what is nearer to the path than they.
    pub(crate) fn reach(&mut self, mesh: &Mesh, rules: &FillRules<'_>, vertices: impl Iterator<Item = VertexId>) {
        for vertex in vertices {
            let is_unknown = |flood: &Self| flood.side_of(vertex).is_none() && flood.is_open(vertex, rules);
            while is_unknown(self) && (0..2).any(|side| self.advance(mesh, rules, side)) {}
        }
    }

    /// Takes the next vertex of a side and colours its neighbours, after a fill that separated. False where there is
    /// none.
    fn advance(&mut self, mesh: &Mesh, rules: &FillRules<'_>, side: usize) -> bool {
        let Some(vertex) = self.queues[side].pop_front() else { return false };
        for &edge in mesh.vertex_edges(vertex) {
            let neighbour = mesh.opposite_vertex(edge, vertex);
            if self.is_open(neighbour, rules) && self.side_of(neighbour).is_none() {
                let wanted = if self.is_crossed(edge) { 1 - side } else { side };
                self.push(wanted, neighbour);
            }
        }
        true
    }

    fn choose_smaller(&self, rules: &FillRules<'_>) -> usize {
        let total = |side: usize, weight: &dyn Fn(VertexId) -> f64| -> f64 {
            self.sides[side].iter().map(|&vertex| weight(vertex)).sum()
        };
        let lowest = |side: usize| self.sides[side].iter().min();
        let order = total(0, rules.weight).total_cmp(&total(1, rules.weight));
        // The fill completed both sides if they weigh the same.
        let order = order.then_with(|| total(0, rules.tie_weight).total_cmp(&total(1, rules.tie_weight)));
        usize::from(order.then_with(|| lowest(0).cmp(&lowest(1))).is_gt())
    }

    fn push_weighed(&mut self, rules: &FillRules<'_>, side: usize, vertex: VertexId) {
        self.push(side, vertex);
        self.weights[side] += (rules.weight)(vertex);
    }

    fn push(&mut self, side: usize, vertex: VertexId) {
        self.colour.set(vertex, u8::from(side == 1));
        self.queues[side].push_back(vertex);
        self.sides[side].push(vertex);
    }

    /// The side on which a vertex was found, if it was visited.
    pub(crate) fn side_of(&self, vertex: VertexId) -> Option<usize> {
        self.colour.get(vertex).map(usize::from)
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
