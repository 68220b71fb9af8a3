//! A tree over the corners of a polygon that finds those in a triangle.

use robust::{Coord, orient2d};

/// Most corners of a leaf.
const LEAF: usize = 8;

/// A k-d tree over points in the plane (Bentley 1975), from which points can be removed.
#[derive(Debug)]
pub(super) struct CornerTree {
    nodes: Vec<Node>,
    /// The corners, those of a leaf in a row.
    corners: Vec<usize>,
    /// The leaf of each corner that is in the tree.
    leaf_of: Vec<usize>,
}

#[derive(Clone, Debug)]
struct Node {
    low: Coord<f64>,
    high: Coord<f64>,
    /// Corners that have not been removed.
    num_left: usize,
    parent: Option<usize>,
    below: Below,
}

#[derive(Clone, Debug)]
enum Below {
    Nodes([usize; 2]),
    Corners(std::ops::Range<usize>),
}

impl CornerTree {
    /// The tree over some corners of `plane`. Cost: O(n log n).
    pub(super) fn new(plane: &[Coord<f64>], mut corners: Vec<usize>) -> Self {
        let mut tree = Self { nodes: Vec::new(), corners: Vec::new(), leaf_of: vec![0; plane.len()] };
        let mut open = vec![(0..corners.len(), None::<(usize, usize)>)];
        while let Some((range, parent)) = open.pop() {
            let own = &mut corners[range.clone()];
            let bound = |pick: fn(f64, f64) -> f64, start: f64| {
                own.iter().fold(Coord { x: start, y: start }, |bound, &corner| Coord {
                    x: pick(bound.x, plane[corner].x),
                    y: pick(bound.y, plane[corner].y),
                })
            };
            let (low, high) = (bound(f64::min, f64::INFINITY), bound(f64::max, f64::NEG_INFINITY));
            let number = tree.nodes.len();
            if let Some((parent, side)) = parent
                && let Below::Nodes(children) = &mut tree.nodes[parent].below
            {
                children[side] = number;
            }
            let below = if own.len() <= LEAF {
                own.iter().for_each(|&corner| tree.leaf_of[corner] = number);
                Below::Corners(range.clone())
            } else {
                let middle = own.len() / 2;
                let key = |corner: usize| {
                    if high.x - low.x >= high.y - low.y { plane[corner].x } else { plane[corner].y }
                };
                own.select_nth_unstable_by(middle, |&a, &b| key(a).total_cmp(&key(b)).then(a.cmp(&b)));
                let cut = range.start + middle;
                open.push((range.start..cut, Some((number, 0))));
                open.push((cut..range.end, Some((number, 1))));
                Below::Nodes([0; 2])
            };
            tree.nodes.push(Node { low, high, num_left: range.len(), parent: parent.map(|(node, _)| node), below });
        }
        tree.corners = corners;
        tree
    }

    /// Removes a corner. Cost: O(log n).
    pub(super) fn remove(&mut self, corner: usize) {
        let mut next = Some(self.leaf_of[corner]);
        while let Some(node) = next {
            self.nodes[node].num_left -= 1;
            next = self.nodes[node].parent;
        }
    }

    /// Number of corners left.
    pub(super) fn num_left(&self) -> usize {
        self.nodes[0].num_left
    }

    /// A corner that lies in the triangle or on its border and is wanted, if there is one; `is_wanted` refuses removed
    /// corners too. Adds the number of signs computed to `num_signs`. The triangle runs counter-clockwise.
    ///
    /// Cost: O(log n) for most triangles without such a corner, at most six signs for each corner left.
    pub(super) fn find(
        &self,
        triangle: [Coord<f64>; 3],
        num_signs: &mut usize,
        mut is_wanted: impl FnMut(usize) -> bool,
    ) -> Option<usize> {
        let [a, b, c] = triangle;
        let edges = [(a, b), (b, c), (c, a)];
        let mut open = vec![0];
        while let Some(node) = open.pop() {
            let Node { low, high, num_left, below, .. } = &self.nodes[node];
            let is_apart = |pick: fn(&Coord<f64>) -> f64| {
                let [a, b, c] = [pick(&a), pick(&b), pick(&c)];
                a.max(b).max(c) < pick(low) || a.min(b).min(c) > pick(high)
            };
            if *num_left == 0 || is_apart(|point| point.x) || is_apart(|point| point.y) {
                continue;
            }
            *num_signs += edges.len();
            if edges.iter().any(|&(from, to)| is_right_of(from, to, *low, *high)) {
                continue;
            }
            match below {
                Below::Nodes(children) => open.extend(children),
                Below::Corners(range) => {
                    *num_signs += edges.len() * num_left;
                    let mut corners = self.corners[range.clone()].iter().copied();
                    if let Some(found) = corners.find(|&corner| is_wanted(corner)) {
                        return Some(found);
                    }
                }
            }
        }
        None
    }
}

/// Whether a whole box lies strictly to the right of a line: whether that corner of it does which lies farthest to the
/// left.
fn is_right_of(from: Coord<f64>, to: Coord<f64>, low: Coord<f64>, high: Coord<f64>) -> bool {
    let x = if to.y > from.y { low.x } else { high.x };
    let y = if to.x > from.x { high.y } else { low.y };
    orient2d(from, to, Coord { x, y }) < 0.0
}
