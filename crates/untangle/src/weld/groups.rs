//! Disjoint sets of vertices, each named by its lowest one.

/// Disjoint sets that are joined one by one.
#[derive(Clone, Debug)]
pub(super) struct Groups {
    parent: Vec<u32>,
}

impl Groups {
    /// Each vertex in a set of its own.
    pub(super) fn new(num_vertices: usize) -> Self {
        Self { parent: (0..u32::try_from(num_vertices).unwrap_or(u32::MAX)).collect() }
    }

    /// The lowest vertex of the set of a vertex.
    pub(super) fn first(&mut self, vertex: u32) -> u32 {
        let mut at = vertex;
        while self.parent[at as usize] != at {
            let above = self.parent[self.parent[at as usize] as usize];
            self.parent[at as usize] = above;
            at = above;
        }
        at
    }

    /// Makes the sets of two vertices one.
    pub(super) fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.first(a), self.first(b));
        self.parent[a.max(b) as usize] = a.min(b);
    }

    /// The lowest vertex of each vertex's set.
    pub(super) fn into_firsts(mut self) -> Vec<u32> {
        (0..self.parent.len()).map(|vertex| self.first(u32::try_from(vertex).unwrap_or(u32::MAX))).collect()
    }
}
