//! Rows by degree: a list for each degree, the latest row first.

const NONE: usize = usize::MAX;

/// Rows in doubly linked lists, one for each degree.
#[derive(Debug, Default)]
pub(super) struct DegreeQueue {
    heads: Vec<usize>,
    next: Vec<usize>,
    previous: Vec<usize>,
    /// For each row in a list its degree.
    degrees: Vec<usize>,
    /// No list below this one has a row.
    least: usize,
}

impl DegreeQueue {
    /// Empties the lists, for `size` rows.
    pub(super) fn start(&mut self, size: usize) {
        for list in [&mut self.heads, &mut self.next, &mut self.previous, &mut self.degrees] {
            list.clear();
            list.resize(size, NONE);
        }
        self.least = 0;
    }

    /// Puts a row that is in no list first in that of its degree, which is below the number of rows.
    pub(super) fn push(&mut self, row: usize, degree: usize) {
        let head = std::mem::replace(&mut self.heads[degree], row);
        self.next[row] = head;
        self.previous[row] = NONE;
        self.degrees[row] = degree;
        if head != NONE {
            self.previous[head] = row;
        }
        self.least = self.least.min(degree);
    }

    /// Takes a row out of its list.
    pub(super) fn remove(&mut self, row: usize) {
        let (next, previous) = (self.next[row], self.previous[row]);
        if next != NONE {
            self.previous[next] = previous;
        }
        if previous == NONE {
            self.heads[self.degrees[row]] = next;
        } else {
            self.next[previous] = next;
        }
    }

    /// Takes out a row of the least degree.
    pub(super) fn pop(&mut self) -> Option<usize> {
        while *self.heads.get(self.least)? == NONE {
            self.least += 1;
        }
        let row = self.heads[self.least];
        self.remove(row);
        Some(row)
    }
}
