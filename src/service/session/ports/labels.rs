//! Labels that fit the room of a sample.

use untangle::labels::VertexLabel;
use untangled_proto::VertexLabel as WireLabel;

/// Fits the labels of frames, reusing its memory.
#[derive(Debug, Default)]
pub(super) struct Labels {
    /// For each vertex that has labels how many.
    counts: Vec<usize>,
}

impl Labels {
    /// Passes labels, ascending by vertex, on to `take`, at most `room` of them. Where there are more, vertices with
    /// more than so many labels have one in place of theirs that stands for all, [`WireLabel::ANY`], so that the mask
    /// becomes wider and loses nothing. `room` must hold one label for each vertex that has any.
    ///
    /// Cost: one pass over the labels; some more where they do not fit.
    pub(super) fn fit(&mut self, labels: &[VertexLabel], room: usize, mut take: impl FnMut(WireLabel)) {
        let most = self.most_labels(labels, room);
        for group in labels.chunk_by(|one, next| one.vertex == next.vertex) {
            match group.first() {
                Some(first) if group.len() > most => take(WireLabel { vertex: first.vertex.0, label: WireLabel::ANY }),
                _ => group.iter().for_each(|label| take(WireLabel { vertex: label.vertex.0, label: label.label })),
            }
        }
    }

    /// Labels of a vertex up to which they are passed on: as many as fit the room.
    fn most_labels(&mut self, labels: &[VertexLabel], room: usize) -> usize {
        if labels.len() <= room {
            return usize::MAX;
        }
        self.counts.clear();
        self.counts.extend(labels.chunk_by(|one, next| one.vertex == next.vertex).map(<[_]>::len));
        // Longest lists last: they are replaced, from the longest on, until what is left fits.
        self.counts.sort_unstable();
        let mut left = labels.len();
        let mut most = usize::MAX;
        for &count in self.counts.iter().rev() {
            if count <= most && left <= room {
                break;
            }
            most = count.saturating_sub(1).max(1);
            left -= count - 1;
        }
        most
    }
}

#[cfg(test)]
mod tests {
    use untangle::mesh::VertexId;

    use super::*;

    fn fit(labels: &[[u32; 2]], room: usize) -> Vec<[u32; 2]> {
        let labels: Vec<_> =
            labels.iter().map(|&[vertex, label]| VertexLabel { vertex: VertexId(vertex), label }).collect();
        let mut fitted = Vec::new();
        Labels::default().fit(&labels, room, |WireLabel { vertex, label }| fitted.push([vertex, label]));
        fitted
    }

    #[test]
    fn labels_that_fit_are_passed_on_and_others_replaced_from_the_longest_lists_on() {
        const ANY: u32 = WireLabel::ANY;
        let all = [[1, 4], [2, 4], [2, 9], [5, 4], [5, 9], [5, 13], [7, 5], [7, 6]];
        assert_eq!(fit(&all, 8), all);
        for room in [6, 7] {
            assert_eq!(fit(&all, room), [[1, 4], [2, 4], [2, 9], [5, ANY], [7, 5], [7, 6]], "room for {room}");
        }
        for room in [4, 5] {
            assert_eq!(fit(&all, room), [[1, 4], [2, ANY], [5, ANY], [7, ANY]], "room for {room}");
        }
        assert_eq!(fit(&all[..1], 1), [[1, 4]]);
        assert_eq!(fit(&[], 0), [[0; 2]; 0]);
    }
}
