//! A tree of boxes (bounding volume hierarchy, Ericson 2004), kept from step to step.

use crate::mesh::Vec3;

/// A box with sides along the axes, in metres.
#[derive(Clone, Copy, Debug)]
pub(super) struct Aabb {
    pub(super) low: Vec3,
    pub(super) high: Vec3,
}

impl Aabb {
    pub(super) fn of<const N: usize>(points: [Vec3; N], margin: f64) -> Self {
        let mut low = points[0];
        let mut high = points[0];
        for point in &points[1..] {
            low = low.inf(point);
            high = high.sup(point);
        }
        Self { low: low.add_scalar(-margin), high: high.add_scalar(margin) }
    }

    pub(super) fn overlaps(&self, other: &Self) -> bool {
        (0..3).all(|axis| self.low[axis] <= other.high[axis] && other.low[axis] <= self.high[axis])
    }

    fn join(&self, other: &Self) -> Self {
        Self { low: self.low.inf(&other.low), high: self.high.sup(&other.high) }
    }
}

/// Most boxes of a leaf.
const LEAF: usize = 4;
/// The tree is built again after so many steps; between them its boxes are refit, which takes a tenth of the time. A
/// tree that is older finds the same, but slower.
const MAX_AGE: u32 = 50;

#[derive(Clone, Copy, Debug)]
struct Node {
    aabb: Aabb,
    /// Its boxes in `order`.
    start: u32,
    end: u32,
    /// The second child; the first one is the next node. Zero for a leaf.
    second: u32,
}

/// Which boxes overlap a box.
#[derive(Clone, Debug, Default)]
pub(super) struct Tree {
    nodes: Vec<Node>,
    /// The boxes in the order of the leaves.
    order: Vec<u32>,
    age: u32,
}

impl Tree {
    /// Takes the boxes as they are now; always the same number of them.
    pub(super) fn update(&mut self, boxes: &[Aabb]) {
        if self.nodes.is_empty() || self.age >= MAX_AGE {
            self.age = 0;
            self.nodes.clear();
            self.order.clear();
            self.order.extend((0..).take(boxes.len()));
            if !boxes.is_empty() {
                self.build(boxes, 0, boxes.len());
            }
        } else {
            self.age += 1;
            self.refit(boxes);
        }
    }

    fn build(&mut self, boxes: &[Aabb], start: usize, end: usize) {
        let items = &mut self.order[start..end];
        let aabb = join_all(boxes, items);
        let node = self.nodes.len();
        let [start_u32, end_u32] = [start, end].map(|place| u32::try_from(place).unwrap_or(u32::MAX));
        self.nodes.push(Node { aabb, start: start_u32, end: end_u32, second: 0 });
        if end - start <= LEAF {
            return;
        }
        let axis = (aabb.high - aabb.low).imax();
        let centre = |item: &u32| boxes[*item as usize].low[axis] + boxes[*item as usize].high[axis];
        let half = items.len() / 2;
        items.select_nth_unstable_by(half, |a, b| centre(a).total_cmp(&centre(b)).then(a.cmp(b)));
        self.build(boxes, start, start + half);
        self.nodes[node].second = u32::try_from(self.nodes.len()).unwrap_or(0);
        self.build(boxes, start + half, end);
    }

    /// Children stand behind their parents.
    fn refit(&mut self, boxes: &[Aabb]) {
        for index in (0..self.nodes.len()).rev() {
            let Node { start, end, second, .. } = self.nodes[index];
            self.nodes[index].aabb = if second == 0 {
                join_all(boxes, &self.order[start as usize..end as usize])
            } else {
                self.nodes[index + 1].aabb.join(&self.nodes[second as usize].aabb)
            };
        }
    }

    /// The boxes from `lowest` on that overlap a box, ascending, into `found`. `boxes` are those of the last update.
    pub(super) fn query(&self, boxes: &[Aabb], aabb: &Aabb, lowest: u32, found: &mut Vec<u32>) {
        found.clear();
        let mut index = 0;
        // Siblings that are still to be visited: one for each level, and 2^64 boxes are more than there are.
        let mut stack = [0; 64];
        let mut depth = 0;
        while let Some(node) = self.nodes.get(index) {
            if node.aabb.overlaps(aabb) {
                if node.second != 0 {
                    stack[depth] = node.second as usize;
                    depth += 1;
                    index += 1;
                    continue;
                }
                let items = &self.order[node.start as usize..node.end as usize];
                found.extend(items.iter().filter(|&&item| item >= lowest && boxes[item as usize].overlaps(aabb)));
            }
            if depth == 0 {
                break;
            }
            depth -= 1;
            index = stack[depth];
        }
        found.sort_unstable();
    }
}

fn join_all(boxes: &[Aabb], items: &[u32]) -> Aabb {
    let first = boxes[items[0] as usize];
    items[1..].iter().fold(first, |sum, &item| sum.join(&boxes[item as usize]))
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    #[test]
    fn query_of_a_new_and_of_an_old_tree_finds_what_overlaps() {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let mut centres: Vec<Vec3> = (0..300).map(|_| Vec3::from_fn(|_, _| rng.random_range(-1.0..1.0))).collect();
        let (mut tree, mut found) = (Tree::default(), Vec::new());
        for _ in 0..MAX_AGE + 3 {
            let boxes: Vec<Aabb> = centres.iter().map(|&centre| Aabb::of([centre], 0.1)).collect();
            tree.update(&boxes);
            for (index, aabb) in (0..).zip(&boxes) {
                let lowest = index / 2;
                tree.query(&boxes, aabb, lowest, &mut found);
                let overlaps = |other: &u32| *other >= lowest && boxes[*other as usize].overlaps(aabb);
                assert_eq!(found, (0..300).filter(overlaps).collect::<Vec<_>>());
            }
            for centre in &mut centres {
                *centre += Vec3::from_fn(|_, _| rng.random_range(-0.1..0.1));
            }
        }
    }
}
