//! The quotient graph of what is left of a matrix while its rows are eliminated.
//!
//! A node is a variable, which stands for one row or several with the same entries, or an element: a variable that was
//! eliminated, with the variables that it met, all of which meet each other now.

use super::queue::DegreeQueue;

const NONE: usize = usize::MAX;

/// A row with more entries than this times the root of the number of rows goes last (Amestoy, Davis and Duff 2004): it
/// would make each elimination slow, and hardly changes what is filled.
const DENSE: usize = 10;
const DENSE_AT_LEAST: usize = 16;

/// The graph; all lists by node, which has the number of its row.
#[derive(Debug, Default)]
pub(super) struct QuotientGraph {
    /// The neighbours of each node, elements before variables; new elements are written behind.
    lists: Vec<usize>,
    starts: Vec<usize>,
    lengths: Vec<usize>,
    elements: Vec<usize>,
    /// For a variable a bound of the number of rows that it meets, its own not counted; for an element their number.
    degrees: Vec<usize>,
    /// The number of rows of a variable; 0 once it is eliminated or part of another one.
    weights: Vec<usize>,
    /// The element that took an element in.
    parents: Vec<usize>,
    is_gone: Vec<bool>,
    is_dense: Vec<bool>,
    /// The rows of a variable, its own first: the next one of each, and the last one.
    next_member: Vec<usize>,
    last_member: Vec<usize>,
    /// The variables of the present pivot are marked with its number.
    pivots: Vec<usize>,
    /// For an element `stamp` and the number of its rows that are not the pivot's; for a node that is compared `stamp`.
    marks: Vec<usize>,
    stamp: usize,
    /// Variables of the present pivot by the sum of their neighbours: the first of each sum, the next of each.
    buckets: Vec<usize>,
    next_in_bucket: Vec<usize>,
    sums: Vec<usize>,
    rows_left: usize,
}

impl QuotientGraph {
    /// Begins with the entries of a matrix, column by column.
    pub(super) fn start(&mut self, starts: &[usize], rows: &[usize]) {
        let size = starts.len() - 1;
        let dense = DENSE_AT_LEAST.max(DENSE * size.isqrt());
        let fill = |list: &mut Vec<usize>, value: usize| {
            list.clear();
            list.resize(size, value);
        };
        for list in [&mut self.parents, &mut self.next_member, &mut self.pivots, &mut self.buckets] {
            fill(list, NONE);
        }
        for list in [&mut self.next_in_bucket, &mut self.sums, &mut self.elements, &mut self.marks] {
            fill(list, 0);
        }
        fill(&mut self.weights, 1);
        self.stamp = 1;
        self.last_member.clear();
        self.last_member.extend(0..size);
        self.is_gone.clear();
        self.is_gone.resize(size, false);
        self.is_dense.clear();
        self.is_dense.extend(starts.windows(2).map(|range| range[1] - range[0] > dense));
        self.rows_left = self.is_dense.iter().filter(|is_dense| !**is_dense).count();
        self.lists.clear();
        self.starts.clear();
        self.lengths.clear();
        for (row, range) in starts.windows(2).enumerate() {
            let start = self.lists.len();
            self.starts.push(start);
            let is_dense = &self.is_dense;
            if !is_dense[row] {
                let entries = rows[range[0]..range[1]].iter().copied();
                self.lists.extend(entries.filter(|&other| other != row && !is_dense[other]));
            }
            self.lengths.push(self.lists.len() - start);
        }
        self.degrees.clear();
        self.degrees.extend_from_slice(&self.lengths);
    }

    /// True for a row that is to be eliminated in its turn.
    pub(super) fn is_waiting(&self, row: usize) -> bool {
        !self.is_dense[row]
    }

    pub(super) fn degree(&self, row: usize) -> usize {
        self.degrees[row]
    }

    pub(super) fn parent(&self, element: usize) -> Option<usize> {
        let parent = self.parents[element];
        (parent != NONE).then_some(parent)
    }

    /// The rows that are eliminated with a pivot, its own first.
    pub(super) fn members(&self, pivot: usize) -> impl Iterator<Item = usize> {
        std::iter::successors(Some(pivot), |&row| Some(self.next_member[row]).filter(|&next| next != NONE))
    }

    /// The rows that were too dense to take part.
    pub(super) fn dense(&self) -> impl Iterator<Item = usize> {
        (0..self.is_dense.len()).filter(|&row| self.is_dense[row])
    }

    /// Makes a variable an element, and gives the queue the new degrees of the variables that it meets.
    pub(super) fn eliminate(&mut self, pivot: usize, queue: &mut DegreeQueue) {
        self.renew_stamp();
        self.rows_left -= self.weights[pivot];
        self.gather(pivot, queue);
        self.count_rows_outside(pivot);
        let (start, end) = (self.starts[pivot], self.starts[pivot] + self.lengths[pivot]);
        for slot in start..end {
            self.shorten(self.lists[slot], pivot);
        }
        for slot in start..end {
            self.join_equals(self.lists[slot]);
        }
        let mut kept = start;
        for slot in start..end {
            let variable = self.lists[slot];
            let weight = self.weights[variable];
            if weight > 0 {
                // The other rows of the pivot's clique, and what is met elsewhere; never more than what is left.
                let bound = self.degrees[variable] + self.degrees[pivot] - weight;
                self.degrees[variable] = bound.min(self.rows_left - weight);
                queue.push(variable, self.degrees[variable]);
                self.lists[kept] = variable;
                kept += 1;
            }
        }
        self.lengths[pivot] = kept - start;
        self.is_gone[pivot] = kept == start;
    }

    /// Makes the list of a pivot: the variables that it and its elements meet. Its elements are part of it from now on.
    fn gather(&mut self, pivot: usize, queue: &mut DegreeQueue) {
        let new = self.lists.len();
        let (start, elements, end) = self.ranges(pivot);
        self.pivots[pivot] = pivot;
        self.degrees[pivot] = 0;
        for slot in start..elements {
            let element = self.lists[slot];
            self.parents[element] = pivot;
            self.is_gone[element] = true;
            self.gather_list(self.starts[element], self.starts[element] + self.lengths[element], pivot, queue);
        }
        self.gather_list(elements, end, pivot, queue);
        self.weights[pivot] = 0;
        self.starts[pivot] = new;
        self.elements[pivot] = 0;
        self.lengths[pivot] = self.lists.len() - new;
    }

    fn gather_list(&mut self, start: usize, end: usize, pivot: usize, queue: &mut DegreeQueue) {
        for slot in start..end {
            let variable = self.lists[slot];
            if self.weights[variable] > 0 && self.pivots[variable] != pivot {
                self.pivots[variable] = pivot;
                self.degrees[pivot] += self.weights[variable];
                self.lists.push(variable);
                queue.remove(variable);
            }
        }
    }

    /// Marks the elements that the pivot's variables meet with the number of their rows that are not the pivot's.
    fn count_rows_outside(&mut self, pivot: usize) {
        let (start, _, end) = self.ranges(pivot);
        for slot in start..end {
            let variable = self.lists[slot];
            let (from, to, _) = self.ranges(variable);
            for slot in from..to {
                let element = self.lists[slot];
                if !self.is_gone[element] {
                    if self.marks[element] < self.stamp {
                        self.marks[element] = self.stamp + self.degrees[element];
                    }
                    self.marks[element] -= self.weights[variable];
                }
            }
        }
    }

    /// Takes out of the list of a variable of the pivot what the pivot stands for now, and finds the number of rows
    /// that it meets elsewhere. One that meets nothing else is eliminated with the pivot.
    fn shorten(&mut self, variable: usize, pivot: usize) {
        let (start, elements, end) = self.ranges(variable);
        let (mut kept, mut degree, mut sum) = (start, 0, 0);
        for slot in start..elements {
            let element = self.lists[slot];
            if self.is_gone[element] {
                continue;
            }
            let outside = self.marks[element] - self.stamp;
            if outside == 0 {
                // All of its rows are the pivot's.
                self.parents[element] = pivot;
                self.is_gone[element] = true;
                continue;
            }
            degree += outside;
            sum += element;
            self.lists[kept] = element;
            kept += 1;
        }
        let first_variable = kept;
        for slot in elements..end {
            let other = self.lists[slot];
            if self.weights[other] > 0 && self.pivots[other] != pivot {
                degree += self.weights[other];
                sum += other;
                self.lists[kept] = other;
                kept += 1;
            }
        }
        if degree == 0 {
            self.rows_left -= self.weights[variable];
            self.degrees[pivot] -= self.weights[variable];
            self.join(variable, pivot);
            return;
        }
        // The pivot, or an element that is part of it now, was in the list: there is room for it.
        if kept > first_variable {
            self.lists[kept] = self.lists[first_variable];
        }
        self.lists[first_variable] = pivot;
        self.elements[variable] = first_variable + 1 - start;
        self.lengths[variable] = kept + 1 - start;
        self.degrees[variable] = self.degrees[variable].min(degree);
        self.sums[variable] = sum % self.buckets.len();
        let bucket = &mut self.buckets[self.sums[variable]];
        self.next_in_bucket[variable] = std::mem::replace(bucket, variable);
    }

    /// Joins the variables with the same neighbours among those with the sum of this one.
    fn join_equals(&mut self, variable: usize) {
        if self.weights[variable] == 0 {
            return;
        }
        let mut first = std::mem::replace(&mut self.buckets[self.sums[variable]], NONE);
        while first != NONE {
            self.stamp_neighbours(first);
            let mut before = first;
            let mut other = self.next_in_bucket[first];
            while other != NONE {
                let next = self.next_in_bucket[other];
                if self.has_stamped_neighbours(other, first) {
                    self.weights[first] += self.weights[other];
                    self.join(other, first);
                    self.next_in_bucket[before] = next;
                } else {
                    before = other;
                }
                other = next;
            }
            first = self.next_in_bucket[first];
        }
    }

    fn stamp_neighbours(&mut self, variable: usize) {
        self.renew_stamp();
        let (start, _, end) = self.ranges(variable);
        for &node in &self.lists[start..end] {
            self.marks[node] = self.stamp;
        }
    }

    fn has_stamped_neighbours(&self, variable: usize, stamped: usize) -> bool {
        let (start, _, end) = self.ranges(variable);
        self.lengths[variable] == self.lengths[stamped]
            && self.elements[variable] == self.elements[stamped]
            && self.lists[start..end].iter().all(|&node| self.marks[node] == self.stamp)
    }

    /// Makes the rows of one variable part of another one.
    fn join(&mut self, variable: usize, other: usize) {
        self.weights[variable] = 0;
        self.next_member[self.last_member[other]] = variable;
        self.last_member[other] = self.last_member[variable];
    }

    fn renew_stamp(&mut self) {
        // Above every mark: a mark is at most a stamp and a number of rows.
        self.stamp += self.weights.len() + 1;
    }

    /// Where the elements of a node's list begin, where its variables do, and where it ends.
    fn ranges(&self, node: usize) -> (usize, usize, usize) {
        let start = self.starts[node];
        (start, start + self.elements[node], start + self.lengths[node])
    }
}
