//! A correction that lists only the vertices it says something about, and the labels of those that are masked.
//!
//! The payload is `[u32]`: [`num_values`](CorrectionHeader::num_values) entries, then
//! [`num_labels`](CorrectionHeader::num_labels) labels, both ascending by vertex.

use super::CorrectionHeader;

/// Words of the payload that a [`VertexEntry`] takes.
pub const ENTRY_WORDS: usize = size_of::<VertexEntry>() / 4;
/// Words of the payload that a [`VertexLabel`] takes.
pub const LABEL_WORDS: usize = size_of::<VertexLabel>() / 4;

/// Correction of one vertex, with its index: 5 words, little-endian.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct VertexEntry {
    /// The vertex.
    pub vertex: u32,
    /// In the unit of the kind asked for.
    pub value: [f32; 3],
    /// See [`flags`](super::flags).
    pub flags: u32,
}

/// A vertex that belongs to a side of a pair of paths: 2 words, little-endian.
///
/// A contact between two ends, each a set of vertices, is off where both ends have labels of one pair whose sides,
/// or-ed, give [`BOTH`](Self::BOTH): one end belongs to the first copy of the path, the other to the second. An end
/// with a label [`ANY`](Self::ANY) goes with each other end that has a label.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
#[repr(C)]
pub struct VertexLabel {
    /// The vertex.
    pub vertex: u32,
    /// `4 * pair + side`.
    pub label: u32,
}

impl VertexLabel {
    /// The side of a pair's first copy.
    pub const FIRST: u32 = 1;
    /// The side of a pair's second copy.
    pub const SECOND: u32 = 2;
    /// Both sides: that of a path that is its own partner, or of a vertex on both sheets.
    pub const BOTH: u32 = 3;
    /// The label of a vertex that belongs to more sides than fit the message: both sides of every pair. It is the only
    /// label of its vertex.
    pub const ANY: u32 = u32::MAX;

    /// The number of the pair: below the number of pairs of the frame it is that of the paths, see
    /// [`PathRecord::pair`](crate::paths::PathRecord::pair), otherwise that plus the number of pairs.
    #[must_use]
    pub fn pair(self) -> u32 {
        self.label >> 2
    }

    /// [`FIRST`](Self::FIRST), [`SECOND`](Self::SECOND) or [`BOTH`](Self::BOTH).
    #[must_use]
    pub fn side(self) -> u32 {
        self.label & Self::BOTH
    }
}

impl CorrectionHeader {
    /// Entries and labels of a sparse payload, in place; nothing where its length is not what this header says, or a
    /// vertex is out of range or out of order.
    ///
    /// Cost: one pass over entries and labels.
    #[must_use]
    pub fn split<'a>(&self, payload: &'a [u32]) -> Option<(&'a [VertexEntry], &'a [VertexLabel])> {
        let (entries, labels) = self.parts(payload)?;
        let in_range = |vertex: Option<u32>| vertex.is_none_or(|vertex| vertex < self.num_vertices);
        let in_order = entries.is_sorted_by(|one, next| one.vertex < next.vertex)
            && labels.is_sorted_by(|one, next| one < next)
            && in_range(entries.last().map(|entry| entry.vertex))
            && in_range(labels.last().map(|label| label.vertex));
        in_order.then_some((entries, labels))
    }

    /// Entries and labels of a sparse payload, in place, with whatever vertices they have; nothing where its length is
    /// not what this header says.
    #[must_use]
    pub fn parts<'a>(&self, payload: &'a [u32]) -> Option<(&'a [VertexEntry], &'a [VertexLabel])> {
        let (num_values, num_labels) = (self.num_values as usize, self.num_labels as usize);
        let entries = payload.get(..num_values.checked_mul(ENTRY_WORDS)?)?;
        let labels = &payload[entries.len()..];
        // SAFETY: both structs are repr(C) of words without padding, with the alignment of a word, so that any words
        // are valid values.
        let (entries, labels) = unsafe { (entries.align_to::<VertexEntry>(), labels.align_to::<VertexLabel>()) };
        let is_whole = entries.2.is_empty() && labels.2.is_empty() && labels.1.len() == num_labels;
        is_whole.then_some((entries.1, labels.1))
    }
}

impl VertexEntry {
    /// The words on the wire.
    #[must_use]
    pub fn to_words(self) -> [u32; ENTRY_WORDS] {
        let [x, y, z] = self.value.map(f32::to_bits);
        [self.vertex, x, y, z, self.flags]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn payload() -> (CorrectionHeader, Vec<u32>) {
        let entry = |vertex| VertexEntry { vertex, value: [0.5, -1.0, 0.0], flags: 2 };
        let mut words: Vec<u32> = [1, 7].into_iter().flat_map(|vertex| entry(vertex).to_words()).collect();
        words.extend([1, 5, 7, 4, 7, 6]);
        let header = CorrectionHeader { num_vertices: 8, num_values: 2, num_labels: 3, ..CorrectionHeader::default() };
        (header, words)
    }

    #[test]
    fn split_reads_entries_and_labels_in_place() {
        let (header, words) = payload();
        let (entries, labels) = header.split(&words).unwrap();
        assert_eq!(entries[1], VertexEntry { vertex: 7, value: [0.5, -1.0, 0.0], flags: 2 });
        assert_eq!(labels[1], VertexLabel { vertex: 7, label: 4 });
        assert_eq!(
            labels.iter().map(|label| (label.pair(), label.side())).collect::<Vec<_>>(),
            [(1, 1), (1, 0), (1, 2)]
        );
        assert_eq!(CorrectionHeader::default().split(&[]), Some((&[][..], &[][..])));
    }

    #[test]
    fn split_rejects_wrong_lengths_and_vertices_out_of_range_or_order() {
        let (header, words) = payload();
        for (num_values, num_labels) in [(1, 3), (3, 3), (2, 2), (2, 4), (u32::MAX, 3)] {
            let lie = CorrectionHeader { num_values, num_labels, ..header };
            assert_eq!(lie.split(&words), None, "{num_values} entries, {num_labels} labels");
        }
        assert_eq!(header.split(&words[1..]), None);
        assert_eq!(CorrectionHeader { num_vertices: 7, ..header }.split(&words), None);
        for (at, word) in [(0, 7), (5, 1), (5, 8), (10, 8), (14, 8), (15, 4)] {
            let mut bad = words.clone();
            bad[at] = word;
            assert_eq!(header.split(&bad), None, "word {at} is {word}");
        }
    }
}
