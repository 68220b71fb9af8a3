//! A tree of boxes round primitives: which of them come within a distance of another one, and which is nearest.

use crate::{primitive::Point, tree::Extent};

/// Most primitives of a leaf.
const LEAF: usize = 4;
/// One, and more than rounding adds to the ratio of two distances.
const ROUNDING: f64 = 1.0 + 1e-9;

/// A binary tree, split in the middle of the order along the longest axis.
pub(crate) struct Boxes {
    extents: Vec<Extent>,
    /// The primitives in the order of the leaves.
    order: Vec<usize>,
    nodes: Vec<Node>,
}

struct Node {
    extent: Extent,
    start: usize,
    end: usize,
    /// The first child is the next node; a leaf has no second.
    second: Option<usize>,
}

impl Boxes {
    pub(crate) fn new<const N: usize>(primitives: impl Iterator<Item = [Point; N]>) -> Self {
        let extents: Vec<Extent> = primitives.map(Extent::of).collect();
        let order = (0..extents.len()).collect();
        let mut tree = Self { extents, order, nodes: Vec::new() };
        if !tree.order.is_empty() {
            tree.build(0, tree.order.len());
        }
        tree
    }

    fn build(&mut self, start: usize, end: usize) {
        let corners = self.order[start..end].iter().flat_map(|&index| {
            let Extent { low, high } = self.extents[index];
            [low, high]
        });
        let extent = Extent::of(corners);
        let node = self.nodes.len();
        self.nodes.push(Node { extent, start, end, second: None });
        if end - start <= LEAF {
            return;
        }
        let length = |axis: usize| extent.high[axis] - extent.low[axis];
        let axis = (1..3).fold(0, |best, axis| if length(axis) > length(best) { axis } else { best });
        let extents = &self.extents;
        let centre = |&index: &usize| 0.5 * extents[index].low[axis] + 0.5 * extents[index].high[axis];
        let middle = start.midpoint(end);
        self.order[start..end]
            .select_nth_unstable_by(middle - start, |a, b| centre(a).total_cmp(&centre(b)).then(a.cmp(b)));
        self.build(start, middle);
        self.nodes[node].second = Some(self.nodes.len());
        self.build(middle, end);
    }

    /// Calls `found` with each primitive whose box comes within a distance of that of another one.
    pub(super) fn near<const N: usize>(&self, primitive: [Point; N], distance: f64, mut found: impl FnMut(usize)) {
        let Extent { low, high } = Extent::of(primitive);
        // Rounded outwards.
        let near = Extent {
            low: low.map(|value| (value - distance).next_down()),
            high: high.map(|value| (value + distance).next_up()),
        };
        let mut stack = if self.nodes.is_empty() { Vec::new() } else { vec![0] };
        while let Some(at) = stack.pop() {
            let node = &self.nodes[at];
            if !node.extent.overlaps(&near) {
                continue;
            }
            if let Some(second) = node.second {
                stack.extend([second, at + 1]);
            } else {
                let members = self.order[node.start..node.end].iter().copied();
                members.filter(|&index| self.extents[index].overlaps(&near)).for_each(&mut found);
            }
        }
    }

    /// The primitive nearest to a point, the first of several; nothing where none is nearer than the root of
    /// `most_squared`. `squared` is the square of its distance.
    pub(crate) fn nearest(&self, at: Point, most_squared: f64, squared: impl Fn(usize) -> f64) -> Option<usize> {
        let mut best: (f64, Option<usize>) = (most_squared, None);
        let mut stack = if self.nodes.is_empty() { Vec::new() } else { vec![(0, self.nodes[0].extent.squared(at))] };
        while let Some((node, from)) = stack.pop() {
            // What rounding takes from the distance of a primitive is less than this.
            if from > best.0 * ROUNDING {
                continue;
            }
            let Node { start, end, second, .. } = self.nodes[node];
            if let Some(second) = second {
                let mut children = [node + 1, second].map(|child| (child, self.nodes[child].extent.squared(at)));
                children.sort_by(|a, b| b.1.total_cmp(&a.1));
                stack.extend(children);
                continue;
            }
            for &index in &self.order[start..end] {
                let distance = squared(index);
                let is_first = best.1.is_some_and(|other| index < other);
                if distance < best.0 || (is_first && distance <= best.0) {
                    best = (distance, Some(index));
                }
            }
        }
        best.1
    }
}
