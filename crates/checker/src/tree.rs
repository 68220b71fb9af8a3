//! Pairs of triangles whose boxes overlap, from a tree of boxes.
//!
//! The boxes of all triangles round one vertex overlap in it. Two of these meet beyond that vertex only along a ray
//! from it, so that round a vertex of many triangles, a *hub*, boxes of the directions in which they lie are compared
//! as well.

use std::ops::ControlFlow;

use crate::{
    groups::{Groups, NO_GROUP},
    primitive::Point,
};

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

    /// The square of the distance of a point, rounded.
    pub(crate) fn squared(&self, at: Point) -> f64 {
        let beyond = |axis: usize| (self.low[axis] - at[axis]).max(at[axis] - self.high[axis]).max(0.0);
        (0..3).map(|axis| beyond(axis) * beyond(axis)).sum()
    }

    fn join(&self, other: &Self) -> Self {
        Self {
            low: std::array::from_fn(|axis| self.low[axis].min(other.low[axis])),
            high: std::array::from_fn(|axis| self.high[axis].max(other.high[axis])),
        }
    }
}

/// What to do after a pair.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Next {
    /// Go on.
    GoOn,
    /// Leave out further pairs of the group that the two have in common, if they have one.
    CloseGroup,
    /// End the search.
    End,
}

/// Looks at a pair of triangles, the lower one first.
pub(crate) type Visit<'a> = dyn FnMut(u32, u32) -> Next + 'a;

/// Most triangles of a leaf.
const LEAF: usize = 4;

/// The hub of triangles that have none in common.
const NO_HUB: u32 = u32::MAX;
/// A vertex of more triangles is a hub.
const MANY: u32 = 64;

/// What the tree knows of one triangle, or of all of a node.
#[derive(Clone, Copy, Debug)]
struct Bounds {
    extent: Extent,
    /// The common hub, or [`NO_HUB`].
    hub: u32,
    /// A box around the unit vectors from the hub to all points.
    directions: Extent,
    /// The common group, or [`NO_GROUP`].
    group: u32,
}

impl Bounds {
    fn join(&self, other: &Self) -> Self {
        let hub = if self.hub == other.hub { self.hub } else { NO_HUB };
        let group = if self.group == other.group { self.group } else { NO_GROUP };
        Self {
            extent: self.extent.join(&other.extent),
            hub,
            directions: self.directions.join(&other.directions),
            group,
        }
    }

    /// Whether some triangles of the two may meet beyond a common hub and are not of one closed group.
    fn may_meet(&self, other: &Self, groups: &Groups) -> bool {
        self.extent.overlaps(&other.extent)
            && (self.group != other.group || !groups.is_closed(self.group))
            && (self.hub == NO_HUB || self.hub != other.hub || self.directions.overlaps(&other.directions))
    }
}

/// A box around all unit vectors.
const ALL_DIRECTIONS: Extent = Extent { low: [-2.0; 3], high: [2.0; 3] };
/// More than the rounding of a unit vector and of the steps after it.
const ROUNDING: f64 = 1e-14;

/// A box around the directions from a point to all others of a triangle.
///
/// They form an arc between those to the two other corners, which is nowhere farther from its chord of length c than
/// c^2 / 4. What can't be computed well lies in any direction.
fn directions(from: Point, a: Point, b: Point) -> Extent {
    let unit = |to: Point| {
        let offset: Point = std::array::from_fn(|axis| to[axis] - from[axis]);
        // Scaled first, so that no square is too large or too small.
        let largest = offset.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
        let scaled = offset.map(|value| value / largest);
        let length = scaled.iter().map(|value| value * value).sum::<f64>().sqrt();
        scaled.map(|value| value / length)
    };
    let [a, b] = [a, b].map(unit);
    let room = (0..3).map(|axis| (b[axis] - a[axis]).powi(2)).sum::<f64>() / 4.0 + ROUNDING;
    if !room.is_finite() {
        return ALL_DIRECTIONS;
    }
    let Extent { low, high } = Extent::of([a, b]);
    Extent { low: low.map(|value| value - room), high: high.map(|value| value + room) }
}

/// The bounds of all triangles.
fn bounds_of(positions: &[Point], triangles: &[[u32; 3]], groups: &Groups) -> Vec<Bounds> {
    let mut num_triangles = vec![0_u32; positions.len()];
    for &vertex in triangles.iter().flatten() {
        num_triangles[vertex as usize] += 1;
    }
    let bounds = |(index, triangle): (usize, &[u32; 3])| {
        let place = |vertex: &u32| positions[*vertex as usize];
        let hub = triangle.iter().copied().filter(|&vertex| num_triangles[vertex as usize] > MANY).min();
        let hub = hub.unwrap_or(NO_HUB);
        let others = triangle.iter().filter(|&&vertex| vertex != hub).map(place);
        let directions = match *others.collect::<Vec<_>>() {
            [a, b] if hub != NO_HUB => directions(positions[hub as usize], a, b),
            _ => ALL_DIRECTIONS,
        };
        Bounds { extent: Extent::of(triangle.iter().map(place)), hub, directions, group: groups.of(index) }
    };
    triangles.iter().enumerate().map(bounds).collect()
}

/// A tree of boxes over triangles, split between hubs, then in the middle of their order along the longest axis.
#[derive(Debug)]
pub(crate) struct Tree {
    bounds: Vec<Bounds>,
    /// The triangles in the order of the leaves.
    order: Vec<u32>,
    nodes: Vec<Node>,
}

#[derive(Debug)]
struct Node {
    bounds: Bounds,
    /// Its triangles in `order`.
    start: usize,
    end: usize,
    /// The first child is the next node; a leaf has no second.
    second: Option<usize>,
}

impl Tree {
    /// The tree of valid triangles.
    pub(crate) fn new(positions: &[Point], triangles: &[[u32; 3]], groups: &Groups) -> Self {
        let bounds = bounds_of(positions, triangles, groups);
        // Triangles of one hub side by side, so that nodes hold those of one.
        let mut order: Vec<u32> = (0..u32::try_from(triangles.len()).unwrap_or(u32::MAX)).collect();
        order.sort_by_key(|&triangle| bounds[triangle as usize].hub);
        let mut tree = Self { bounds, order, nodes: Vec::new() };
        if !triangles.is_empty() {
            tree.build(0, tree.order.len());
        }
        tree
    }

    fn build(&mut self, start: usize, end: usize) {
        let Self { bounds: all, order, nodes } = self;
        let first = all[order[start] as usize];
        let bounds = order[start + 1..end].iter().fold(first, |sum, &triangle| sum.join(&all[triangle as usize]));
        let node = nodes.len();
        nodes.push(Node { bounds, start, end, second: None });
        if end - start <= LEAF {
            return;
        }
        let middle = self.split(start, end, bounds);
        self.build(start, middle);
        self.nodes[node].second = Some(self.nodes.len());
        self.build(middle, end);
    }

    /// Divides the triangles of a node: between two hubs, or those of one in the middle along the longest axis. Gives
    /// back where the second half starts.
    fn split(&mut self, start: usize, end: usize, bounds: Bounds) -> usize {
        let Self { bounds: all, order, .. } = self;
        let middle = start.midpoint(end);
        let hub = |triangle: u32| all[triangle as usize].hub;
        if hub(order[start]) != hub(order[end - 1]) {
            let own = hub(order[middle]);
            let first = start + order[start..end].partition_point(|&triangle| hub(triangle) < own);
            let last = start + order[start..end].partition_point(|&triangle| hub(triangle) <= own);
            return if first > start { first } else { last };
        }
        let place = |bounds: &Bounds| if bounds.hub == NO_HUB { bounds.extent } else { bounds.directions };
        let Extent { low, high } = place(&bounds);
        let length = |axis: usize| high[axis] - low[axis];
        let axis = (1..3).fold(0, |best, axis| if length(axis) > length(best) { axis } else { best });
        // Halves first, so that no sum overflows.
        let centre = |triangle: u32| {
            let Extent { low, high } = place(&all[triangle as usize]);
            0.5 * low[axis] + 0.5 * high[axis]
        };
        order[start..end]
            .select_nth_unstable_by(middle - start, |&a, &b| centre(a).total_cmp(&centre(b)).then(a.cmp(&b)));
        middle
    }

    /// Calls `visit` for each pair of triangles whose boxes overlap, the lower one first, until that ends it. Pairs
    /// that can only meet in a common hub are left out, and those of a closed group. `groups` are those of the tree.
    pub(crate) fn pairs(&self, groups: &mut Groups, visit: &mut Visit<'_>) {
        if !self.nodes.is_empty() {
            // The search is over where it breaks off.
            let _ = self.pairs_of(0, 0, groups, visit);
        }
    }

    fn pairs_of(&self, a: usize, b: usize, groups: &mut Groups, visit: &mut Visit<'_>) -> ControlFlow<()> {
        let [first, second] = [a, b].map(|node| &self.nodes[node]);
        if !first.bounds.may_meet(&second.bounds, groups) {
            return ControlFlow::Continue(());
        }
        let pairs = match (first.second, second.second) {
            (None, None) => return self.pairs_of_leaves(first, second, groups, visit),
            (Some(child), _) if a == b => &[(a + 1, a + 1), (a + 1, child), (child, child)][..],
            (Some(child), other) if other.is_none() || first.end - first.start >= second.end - second.start => {
                &[(a + 1, b), (child, b)]
            }
            (_, Some(child)) => &[(a, b + 1), (a, child)],
            (Some(_), None) => unreachable!("the node {a} with children is split"),
        };
        pairs.iter().try_for_each(|&(a, b)| self.pairs_of(a, b, groups, visit))
    }

    fn pairs_of_leaves(
        &self,
        first: &Node,
        second: &Node,
        groups: &mut Groups,
        visit: &mut Visit<'_>,
    ) -> ControlFlow<()> {
        for at in first.start..first.end {
            let from = if first.start == second.start { at + 1 } else { second.start };
            for &other in &self.order[from..second.end] {
                let own = self.order[at];
                if self.bounds[own as usize].may_meet(&self.bounds[other as usize], groups) {
                    match visit(own.min(other), own.max(other)) {
                        Next::GoOn => {}
                        Next::CloseGroup => groups.close_common(own, other),
                        Next::End => return ControlFlow::Break(()),
                    }
                }
            }
        }
        ControlFlow::Continue(())
    }
}
