//! The order of rows, and the band that all entries lie in.

const NONE: usize = usize::MAX;
/// A band is narrow up to so many multiplications for each row: beyond them a sparse factorisation takes less time.
const MOST_PER_ROW: usize = 4_000;
/// Entries that go together: columns are padded with zeros to a multiple of them, so that loops have few lengths.
pub(super) const GROUP: usize = 4;

/// The order of rows, and how far the entries of each column reach in it (Cuthill and McKee 1969).
#[derive(Debug, Default)]
pub(crate) struct Band {
    /// For each vertex its row.
    places: Vec<usize>,
    /// Where the entries of each column begin, the diagonal first, then those below it in whole groups. A column
    /// reaches no less far than those before it.
    pub(super) starts: Vec<usize>,
    /// The number of entries of each column below its diagonal.
    pub(super) lengths: Vec<usize>,
    /// The vertices row by row.
    order: Vec<usize>,
    triangles: Vec<[u32; 3]>,
    /// For each vertex where its triangles begin in the list behind.
    firsts: Vec<u32>,
    of_vertices: Vec<u32>,
}

impl Band {
    /// Finds the band of the mesh of some triangles, and says whether it is narrow. The order is that of a walk from
    /// the end of a walk from `root`.
    ///
    /// Cost: linear in the triangles.
    pub(crate) fn find(&mut self, num_vertices: usize, root: usize, triangles: impl Iterator<Item = [u32; 3]>) -> bool {
        self.triangles.clear();
        self.triangles.extend(triangles);
        self.sort_by_vertex(num_vertices);
        self.places.clear();
        self.places.resize(num_vertices, NONE);
        self.order.clear();
        for vertex in std::iter::once(root).chain(0..num_vertices) {
            if self.places[vertex] == NONE {
                let first = self.order.len();
                self.walk(vertex);
                let farthest = self.order[self.order.len() - 1];
                for &vertex in &self.order[first..] {
                    self.places[vertex] = NONE;
                }
                self.order.truncate(first);
                self.walk(farthest);
            }
        }
        self.measure()
    }

    fn sort_by_vertex(&mut self, num_vertices: usize) {
        self.firsts.clear();
        self.firsts.resize(num_vertices + 1, 0);
        for corner in self.triangles.as_flattened() {
            self.firsts[*corner as usize] += 1;
        }
        let mut end = 0;
        for first in &mut self.firsts {
            end += *first;
            *first = end;
        }
        self.of_vertices.clear();
        self.of_vertices.resize(3 * self.triangles.len(), 0);
        for (number, triangle) in (0u32..).zip(&self.triangles) {
            for &corner in triangle {
                let first = &mut self.firsts[corner as usize];
                *first -= 1;
                self.of_vertices[*first as usize] = number;
            }
        }
    }

    /// Appends the vertices that are connected with one, the nearest first.
    fn walk(&mut self, root: usize) {
        let mut next = self.order.len();
        self.places[root] = next;
        self.order.push(root);
        while next < self.order.len() {
            let vertex = self.order[next];
            for &triangle in &self.of_vertices[self.firsts[vertex] as usize..self.firsts[vertex + 1] as usize] {
                for &corner in &self.triangles[triangle as usize] {
                    let place = &mut self.places[corner as usize];
                    if *place == NONE {
                        *place = self.order.len();
                        self.order.push(corner as usize);
                    }
                }
            }
            next += 1;
        }
    }

    fn measure(&mut self) -> bool {
        let count = self.order.len();
        // First the last row that each column has an entry in.
        self.starts.clear();
        self.starts.extend(0..=count);
        for triangle in &self.triangles {
            let [a, b, c] = triangle.map(|corner| self.places[corner as usize]);
            let last = &mut self.starts[a.min(b).min(c)];
            *last = (*last).max(a).max(b).max(c);
            let (low, high) = (a.min(b).max(a.max(b).min(c)), a.max(b).max(c));
            let last = &mut self.starts[low];
            *last = (*last).max(high);
        }
        let (mut start, mut last, mut cost) = (0, 0, 0usize);
        self.lengths.clear();
        for (row, slot) in self.starts[..count].iter_mut().enumerate() {
            last = last.max(*slot);
            *slot = start;
            self.lengths.push(last - row);
            start += 1 + (last - row).next_multiple_of(GROUP);
            cost += (last + 1 - row).pow(2);
        }
        self.starts[count] = start;
        cost <= MOST_PER_ROW * count
    }

    /// The row of each vertex.
    pub(crate) fn places(&self) -> &[usize] {
        &self.places
    }
}
