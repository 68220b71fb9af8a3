//! Which contacts of the host's own have to be off while a tangle comes apart.

use untangled_proto::VertexLabel;

/// Decides by the labels of a correction which contacts are off: those between the two sides of one pair of paths, and
/// no others.
///
/// A label is `4 * pair + side`, with side 1 for the first sheet of the pair, 2 for the second, 3 for both. A contact
/// has two ends: a vertex and a face, or two edges. An end holds the labels of all its vertices: a face that reaches
/// across the rim of what is labelled would otherwise hold back a vertex that has to pass. The contact is off where
/// both ends hold labels of one pair whose sides, or-ed, give 3. The label [`VertexLabel::ANY`] of a vertex that
/// belongs to more pairs than fit a message is of both sides of every pair.
///
/// Plain data: it knows no session, and is filled from the labels of a correction or of the library. Cost: a contact
/// whose vertex, or one of whose edges, has no label takes one or two look-ups, and most have none; the memory is one
/// `u32` for each vertex, and is kept from frame to frame.
///
/// ```
/// use untangled_client::ContactFilter;
///
/// let mut filter = ContactFilter::new(6);
/// filter.set([(0, 4 * 7 + 1), (5, 4 * 7 + 2)]); // vertex 0 on the first side of pair 7, vertex 5 on the second
/// assert!(filter.vertex_face_is_off(0, [3, 4, 5]));
/// assert!(!filter.vertex_face_is_off(1, [3, 4, 5]));
/// assert!(filter.edge_edge_is_off([0, 1], [4, 5]));
/// ```
#[derive(Clone, Debug, Default)]
pub struct ContactFilter {
    /// For each vertex the number of its first entry plus one, or zero.
    first: Vec<u32>,
    /// Vertices and labels, by vertex.
    entries: Vec<(u32, u32)>,
}

impl ContactFilter {
    /// A filter that switches no contact off, for so many vertices.
    #[must_use]
    pub fn new(num_vertices: usize) -> Self {
        Self { first: vec![0; num_vertices], entries: Vec::new() }
    }

    /// Takes the labels of a frame, `(vertex, label)`, in place of those before. They come in ascending order; others
    /// are sorted first. Vertices that the filter has no room for are left out.
    ///
    /// Cost: linear in the labels of both frames.
    pub fn set(&mut self, labels: impl IntoIterator<Item = (u32, u32)>) {
        self.clear();
        let num_vertices = self.first.len();
        self.entries.extend(labels.into_iter().filter(|&(vertex, _)| (vertex as usize) < num_vertices));
        if !self.entries.is_sorted() {
            self.entries.sort_unstable();
        }
        for (number, &(vertex, _)) in (1..).zip(&self.entries) {
            let first = &mut self.first[vertex as usize];
            if *first == 0 {
                *first = number;
            }
        }
    }

    /// Switches all contacts on.
    pub fn clear(&mut self) {
        for &(vertex, _) in &self.entries {
            self.first[vertex as usize] = 0;
        }
        self.entries.clear();
    }

    /// Whether it switches no contact off.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// Whether the contact of a vertex and a face is off.
    #[inline]
    #[must_use]
    pub fn vertex_face_is_off(&self, vertex: u32, face: [u32; 3]) -> bool {
        self.has_labels(vertex) && self.is_off(&[vertex], &face)
    }

    /// Whether the contact of two edges is off.
    #[inline]
    #[must_use]
    pub fn edge_edge_is_off(&self, first: [u32; 2], second: [u32; 2]) -> bool {
        let has_labels = |[a, b]: [u32; 2]| self.has_labels(a) || self.has_labels(b);
        has_labels(first) && has_labels(second) && self.is_off(&first, &second)
    }

    /// Writes for each contact of a vertex and a face whether it is off.
    ///
    /// # Panics
    /// Where the slices have different lengths.
    pub fn vertex_faces_off(&self, vertices: &[u32], faces: &[[u32; 3]], off: &mut [bool]) {
        assert!(vertices.len() == faces.len() && faces.len() == off.len(), "one vertex, face and answer each");
        for ((off, &vertex), &face) in off.iter_mut().zip(vertices).zip(faces) {
            *off = self.vertex_face_is_off(vertex, face);
        }
    }

    /// Writes for each contact of two edges whether it is off.
    ///
    /// # Panics
    /// Where the slices have different lengths.
    pub fn edge_edges_off(&self, first: &[[u32; 2]], second: &[[u32; 2]], off: &mut [bool]) {
        assert!(first.len() == second.len() && second.len() == off.len(), "two edges and an answer each");
        for ((off, &first), &second) in off.iter_mut().zip(first).zip(second) {
            *off = self.edge_edge_is_off(first, second);
        }
    }

    /// Whether a vertex has labels: contacts of it may be off.
    #[inline]
    #[must_use]
    pub fn has_labels(&self, vertex: u32) -> bool {
        self.first.get(vertex as usize).is_some_and(|&first| first != 0)
    }

    /// The labels of a vertex.
    fn labels(&self, vertex: u32) -> impl Iterator<Item = u32> + Clone + '_ {
        let first = self.first.get(vertex as usize).map_or(0, |&first| first as usize);
        let entries = if first == 0 { &[] } else { &self.entries[first - 1..] };
        entries.iter().take_while(move |&&(of, _)| of == vertex).map(|&(_, label)| label)
    }

    fn is_off(&self, first: &[u32], second: &[u32]) -> bool {
        let of_first = first.iter().flat_map(|&vertex| self.labels(vertex));
        let of_second = second.iter().flat_map(|&vertex| self.labels(vertex));
        of_first.into_iter().any(|a| of_second.clone().any(|b| is_opposite(a, b)))
    }
}

/// Whether two labels are of one pair, and of both its sides.
fn is_opposite(a: u32, b: u32) -> bool {
    a >> 2 == b >> 2 && (a | b) & 3 == 3 || a == VertexLabel::ANY || b == VertexLabel::ANY
}

#[cfg(test)]
mod tests {
    use super::*;

    fn label(pair: u32, side: u32) -> u32 {
        4 * pair + side
    }

    #[test]
    fn filter_switches_off_opposite_sides_of_one_pair_only() {
        let mut filter = ContactFilter::new(10);
        filter.set([(0, label(2, 1)), (1, label(2, 2)), (2, label(3, 2)), (3, label(2, 1)), (3, label(5, 3))]);
        let off = |vertex, corner| filter.vertex_face_is_off(vertex, [8, corner, 9]);
        assert!(off(0, 1) && off(1, 0) && off(1, 3));
        assert!(!off(0, 3), "the same side");
        assert!(!off(0, 2) && !off(2, 0), "another pair");
        assert!(!off(7, 1) && !off(0, 7), "no label");
        assert!(off(3, 3), "a path that is its own partner");
        filter.set([(0, label(2, 1)), (1, VertexLabel::ANY), (4, VertexLabel::ANY)]);
        let off = |vertex, corner| filter.vertex_face_is_off(vertex, [8, corner, 9]);
        assert!(off(0, 1) && off(1, 0) && off(1, 4) && !off(1, 7) && !off(7, 4), "more labels than fit");
        assert!(filter.edge_edge_is_off([9, 0], [1, 9]) && !filter.edge_edge_is_off([9, 0], [3, 9]));
    }

    #[test]
    fn set_takes_labels_in_place_of_those_before() {
        let mut filter = ContactFilter::new(4);
        filter.set([(0, label(0, 1)), (1, label(0, 2))]);
        filter.set([(3, label(0, 2)), (2, label(0, 1)), (9, label(0, 3))]);
        assert!(!filter.vertex_face_is_off(0, [1, 1, 1]) && filter.vertex_face_is_off(2, [1, 3, 0]));
        assert!(!filter.vertex_face_is_off(9, [9, 9, 9]), "a vertex beyond the mesh has no label");
        filter.clear();
        assert!(filter.is_empty() && !filter.vertex_face_is_off(2, [1, 3, 0]));
    }

    #[test]
    fn slices_are_answered_as_single_contacts() {
        let mut filter = ContactFilter::new(4);
        filter.set([(0, label(1, 1)), (3, label(1, 2))]);
        let mut off = [false; 3];
        filter.vertex_faces_off(&[0, 1, 3], &[[1, 2, 3], [0, 2, 3], [0, 1, 2]], &mut off);
        assert_eq!(off, [true, false, true]);
        filter.edge_edges_off(&[[0, 1], [1, 2], [3, 1]], &[[2, 3], [0, 3], [2, 1]], &mut off);
        assert_eq!(off, [true, false, false]);
    }
}
