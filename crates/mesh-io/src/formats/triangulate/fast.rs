//! Clipping ears of large polygons.

use std::collections::BTreeSet;

use super::{Polygon, corner_tree::CornerTree, emit_fan};

/// Most orientation signs for one polygon, and more for each of its corners. A polygon for which they do not suffice,
/// since it crosses itself again and again, becomes a fan.
const MOST_SIGNS: usize = 120_000_000;
const MOST_SIGNS_OF_A_CORNER: usize = 1_000;

/// Clips the ears that [`clip_plainly`](super::clip_plainly) clips, in the same order.
///
/// It looks for obstacles in a tree, and looks at a corner again only when the answer may have changed: when a
/// neighbour of the corner or the obstacle that was found has been clipped. All other corners are known to be no ears,
/// and are skipped where the plain search would look at them in vain.
///
/// Cost: O(n log n) where each corner is looked at some times only, as in polygons that people and exporters make; at
/// most [`MOST_SIGNS`] and [`MOST_SIGNS_OF_A_CORNER`] for each corner in all others.
pub(super) fn clip(polygon: Polygon<'_>, emit: &mut dyn FnMut([usize; 3])) {
    let mut ring = Ring::new(polygon);
    let most_signs = MOST_SIGNS.saturating_add(MOST_SIGNS_OF_A_CORNER.saturating_mul(polygon.points.len()));
    let mut from = 1;
    while ring.num_left > 3 && ring.num_signs < most_signs {
        let next = ring.candidates.range(from..).next().or_else(|| ring.candidates.first());
        let Some(&tip) = next else { break };
        ring.candidates.remove(&tip);
        from = tip + 1;
        let ear = [ring.before[tip], tip, ring.after[tip]];
        if !polygon.turns_left(ear[0], ear[1], ear[2]) {
            continue;
        }
        match ring.obstacle(ear) {
            Some(obstacle) => ring.waiting[obstacle].push(tip),
            None => {
                emit(ear);
                ring.clip(ear);
                // As in the plain search, which goes on at the second corner after it has clipped the last one.
                if ring.after[tip] < tip {
                    from = ring.after[ring.first];
                }
            }
        }
    }
    emit_fan(&ring.left(), emit);
}

/// The corners that are left.
struct Ring<'a> {
    polygon: Polygon<'a>,
    before: Vec<usize>,
    after: Vec<usize>,
    is_left: Vec<bool>,
    num_left: usize,
    first: usize,
    /// Corners that may be tips of ears.
    candidates: BTreeSet<usize>,
    /// For each corner the tips of which it was found to be an obstacle.
    waiting: Vec<Vec<usize>>,
    tree: CornerTree,
    /// Corners in the tree when it was built.
    num_built: usize,
    num_signs: usize,
}

impl<'a> Ring<'a> {
    fn new(polygon: Polygon<'a>) -> Self {
        let count = polygon.points.len();
        Self {
            polygon,
            before: (0..count).map(|corner| (corner + count - 1) % count).collect(),
            after: (0..count).map(|corner| (corner + 1) % count).collect(),
            is_left: vec![true; count],
            num_left: count,
            first: 0,
            candidates: (0..count).collect(),
            waiting: vec![Vec::new(); count],
            tree: CornerTree::new(polygon.plane, (0..count).collect()),
            num_built: count,
            num_signs: 0,
        }
    }

    /// A corner that keeps three others from being an ear.
    fn obstacle(&mut self, ear: [usize; 3]) -> Option<usize> {
        let Self { polygon, is_left, tree, num_signs, .. } = self;
        let triangle = ear.map(|corner| polygon.plane[corner]);
        tree.find(triangle, num_signs, |other| is_left[other] && polygon.obstructs(other, ear))
    }

    /// Removes the tip of an ear. Its neighbours and the corners to which it was an obstacle become candidates.
    fn clip(&mut self, [before, tip, after]: [usize; 3]) {
        (self.after[before], self.before[after]) = (after, before);
        self.is_left[tip] = false;
        self.num_left -= 1;
        if tip == self.first {
            self.first = after;
        }
        self.candidates.extend([before, after]);
        let Self { waiting, is_left, candidates, .. } = self;
        candidates.extend(std::mem::take(&mut waiting[tip]).into_iter().filter(|&corner| is_left[corner]));
        self.tree.remove(tip);
        // A tree of which half is gone has nodes for nothing.
        if 2 * self.tree.num_left() < self.num_built {
            self.num_built = self.num_left;
            self.tree = CornerTree::new(self.polygon.plane, self.left());
        }
    }

    /// The corners in order.
    fn left(&self) -> Vec<usize> {
        (0..self.is_left.len()).filter(|&corner| self.is_left[corner]).collect()
    }
}
