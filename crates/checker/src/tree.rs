//! Pairs of triangles whose boxes overlap, from a tree of boxes.

use crate::primitive::Point;

/// A box with sides along the axes. Made of input coordinates only: nothing is rounded.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extent {
    pub(crate) low: Point,
    pub(crate) high: Point,
}

impl Extent {
    pub(crate) fn of(points: impl IntoIterator<Item = Point>) -> Self {
        let empty = Self { low: [f64::INFINITY; 3], high: [f64::NEG_INFINITY; 3] };
        points.into_iter().fold(empty, |mut extent, point| {
            for ((low, high), value) in extent.low.iter_mut().zip(&mut extent.high).zip(point) {
                *low = low.min(value);
                *high = high.max(value);
            }
            extent
        })
    }

    pub(crate) fn overlaps(&self, other: &Self) -> bool {
        (0..3).all(|axis| self.low[axis] <= other.high[axis] && other.low[axis] <= self.high[axis])
    }

    fn join(&self, other: &Self) -> Self {
        Self {
            low: std::array::from_fn(|axis| self.low[axis].min(other.low[axis])),
            high: std::array::from_fn(|axis| self.high[axis].max(other.high[axis])),
        }
    }
}

/// Most triangles of a leaf.
const LEAF: usize = 4;

/// A tree of boxes over triangles, split in the middle of their order along the longest axis.
#[derive(Debug)]
pub(crate) struct Tree {
    extents: Vec<Extent>,
    /// The triangles in the order of the leaves.
    order: Vec<u32>,
    nodes: Vec<Node>,
}

#[derive(Debug)]
struct Node {
    extent: Extent,
    /// Its triangles in `order`.
    start: usize,
    end: usize,
    /// The first child is the next node; a leaf has no second.
    second: Option<usize>,
}

impl Tree {
    pub(crate) fn new(extents: Vec<Extent>) -> Self {
        let order = (0..u32::try_from(extents.len()).unwrap_or(u32::MAX)).collect();
        let mut tree = Self { extents, order, nodes: Vec::new() };
        tree.build(0, tree.order.len());
        tree
    }

    fn build(&mut self, start: usize, end: usize) {
        let Self { extents, order, nodes } = self;
        let own = order[start..end].iter().map(|&triangle| extents[triangle as usize]);
        let extent = own.reduce(|a, b| a.join(&b)).unwrap_or_else(|| Extent::of([]));
        let node = nodes.len();
        nodes.push(Node { extent, start, end, second: None });
        if end - start <= LEAF {
            return;
        }
        let length = |axis: usize| extent.high[axis] - extent.low[axis];
        let axis = (1..3).fold(0, |best, axis| if length(axis) > length(best) { axis } else { best });
        let middle = start.midpoint(end);
        // Halves first, so that no sum overflows.
        let centre = |triangle: u32| {
            let Extent { low, high } = extents[triangle as usize];
            0.5 * low[axis] + 0.5 * high[axis]
        };
        order[start..end]
            .select_nth_unstable_by(middle - start, |&a, &b| centre(a).total_cmp(&centre(b)).then(a.cmp(&b)));
        self.build(start, middle);
        self.nodes[node].second = Some(self.nodes.len());
        self.build(middle, end);
    }

    /// Calls `visit` for each pair of triangles whose boxes overlap, the lower one first, until it returns false.
    pub(crate) fn pairs(&self, visit: &mut dyn FnMut(u32, u32) -> bool) {
        if !self.nodes.is_empty() {
            self.pairs_of(0, 0, visit);
        }
    }

    /// The pairs of two nodes; false if `visit` ended it.
    fn pairs_of(&self, a: usize, b: usize, visit: &mut dyn FnMut(u32, u32) -> bool) -> bool {
        let [first, second] = [a, b].map(|node| &self.nodes[node]);
        if !first.extent.overlaps(&second.extent) {
            return true;
        }
        match (first.second, second.second) {
            (None, None) => self.pairs_of_leaves(first, second, visit),
            (Some(child), _) if a == b => {
                self.pairs_of(a + 1, a + 1, visit)
                    && self.pairs_of(a + 1, child, visit)
                    && self.pairs_of(child, child, visit)
            }
            (Some(child), other) if other.is_none() || first.end - first.start >= second.end - second.start => {
                self.pairs_of(a + 1, b, visit) && self.pairs_of(child, b, visit)
            }
            (_, Some(child)) => self.pairs_of(a, b + 1, visit) && self.pairs_of(a, child, visit),
            (Some(_), None) => unreachable!("the node {a} with children is split"),
        }
    }

    fn pairs_of_leaves(&self, first: &Node, second: &Node, visit: &mut dyn FnMut(u32, u32) -> bool) -> bool {
        for at in first.start..first.end {
            let from = if first.start == second.start { at + 1 } else { second.start };
            for &other in &self.order[from..second.end] {
                let own = self.order[at];
                if self.extents[own as usize].overlaps(&self.extents[other as usize])
                    && !visit(own.min(other), own.max(other))
                {
                    return false;
                }
            }
        }
        true
    }
}
