//! An order of elimination that fills the factor of a sparse symmetric matrix little: approximate minimum degree
//! (Amestoy, Davis and Duff 1996), in memory that is kept.
//!
//! The next row is always one with the fewest entries left, by an upper bound that is cheap to keep. The rows that are
//! left are held as a quotient graph ([`QuotientGraph`]): a row that is eliminated becomes an element, the clique of
//! the rows that it met, so that eliminating takes no more memory than the factor.
//!
//! By hand, since a linear algebra library that has it takes a third of the first build. It is whole numbers only:
//! the same order on every processor.
//!
//! | file | what |
//! |---|---|
//! | `mod` | the elimination from row to row, and the order at the end |
//! | `graph` | the quotient graph: elements, supervariables, their degrees |
//! | `queue` | rows by degree |

mod graph;
mod queue;
#[cfg(test)]
mod tests;

use graph::QuotientGraph;
use queue::DegreeQueue;

const NONE: usize = usize::MAX;

/// The memory of an ordering.
#[derive(Debug, Default)]
pub(super) struct MinimumDegree {
    graph: QuotientGraph,
    queue: DegreeQueue,
    /// Pivots, in the order in which they were eliminated.
    pivots: Vec<usize>,
    /// For each pivot its first child in the forest of elements, for each child the next one.
    children: Vec<usize>,
    siblings: Vec<usize>,
    stack: Vec<usize>,
}

impl MinimumDegree {
    /// Finds the order of elimination of a matrix of which both halves are given column by column, the diagonal or not:
    /// `order[step]` is the row that a step eliminates. Each step follows those that it depends on, and these one
    /// another, as a depth-first walk of the elimination tree does.
    ///
    /// Among rows of the same degree the one goes first whose degree became known last, among the first ones the last
    /// row.
    ///
    /// Cost: for a mesh of n vertices about O(n log n).
    pub(super) fn find(&mut self, starts: &[usize], rows: &[usize], order: &mut Vec<usize>) {
        let size = starts.len() - 1;
        self.pivots.clear();
        self.queue.start(size);
        self.graph.start(starts, rows);
        for row in 0..size {
            if self.graph.is_waiting(row) {
                self.queue.push(row, self.graph.degree(row));
            }
        }
        while let Some(pivot) = self.queue.pop() {
            self.pivots.push(pivot);
            self.graph.eliminate(pivot, &mut self.queue);
        }
        self.walk(size, order);
    }

    /// Writes the rows of each tree of elements, children before their parent, then the rows that were too dense.
    fn walk(&mut self, size: usize, order: &mut Vec<usize>) {
        self.children.clear();
        self.children.resize(size, NONE);
        self.siblings.clear();
        self.siblings.resize(size, NONE);
        // Backwards, so that the first child is the one that was eliminated first.
        for &pivot in self.pivots.iter().rev() {
            if let Some(parent) = self.graph.parent(pivot) {
                self.siblings[pivot] = std::mem::replace(&mut self.children[parent], pivot);
            }
        }
        order.clear();
        for place in 0..self.pivots.len() {
            let root = self.pivots[place];
            if self.graph.parent(root).is_none() {
                self.walk_tree(root, order);
            }
        }
        order.extend(self.graph.dense());
    }

    fn walk_tree(&mut self, root: usize, order: &mut Vec<usize>) {
        self.stack.clear();
        self.stack.push(root);
        while let Some(&at) = self.stack.last() {
            let child = self.children[at];
            if child == NONE {
                self.stack.pop();
                order.extend(self.graph.members(at));
            } else {
                self.children[at] = self.siblings[child];
                self.stack.push(child);
            }
        }
    }
}
