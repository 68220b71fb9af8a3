//! Corrections, paths and views, as clients read them.

use untangled_client::{
    ContactFilter,
    observe::{Observation, ObservedMesh},
};
use untangled_proto::{
    CorrectionHeader, VertexEntry, VertexLabel,
    correction::sparse::{ENTRY_WORDS, LABEL_WORDS},
    paths::{PathPoint, PathRecord, PathsHeader},
    view::{InsideEntry, ViewHeader},
};

/// Most vertices of a session, so that many labels meet.
const MOST_VERTICES: u8 = 24;

/// Numbers of vertices, values and labels, one byte each, then a sparse payload. What is accepted is what the words
/// say, in order and in range; contacts are off as the definition says.
pub(super) fn correction(bytes: &[u8]) -> bool {
    let Some((&[num_vertices, num_values, num_labels], rest)) = bytes.split_first_chunk::<3>() else { return false };
    let num_vertices = u32::from(num_vertices % MOST_VERTICES);
    let header = CorrectionHeader {
        num_vertices,
        num_values: if num_values == u8::MAX { u32::MAX } else { num_values.into() },
        num_labels: if num_labels == u8::MAX { u32::MAX } else { num_labels.into() },
        ..CorrectionHeader::default()
    };
    let words: Vec<u32> = rest.as_chunks::<4>().0.iter().map(|word| u32::from_le_bytes(*word)).collect();
    let length = header.num_values as usize * ENTRY_WORDS + header.num_labels as usize * LABEL_WORDS;
    let (entries, labels) = match header.split(&words) {
        Some(parts) => parts,
        None => {
            assert!(words.len() != length || !is_in_order(&header, &words), "what is right is accepted");
            return false;
        }
    };
    assert!(words.len() == length && is_in_order(&header, &words), "what is accepted is right");
    let written: Vec<u32> = entries.iter().flat_map(|entry| VertexEntry::to_words(*entry)).collect();
    let written_labels = labels.iter().flat_map(|label| [label.vertex, label.label]);
    assert!(written.into_iter().chain(written_labels).eq(words.iter().copied()), "words come back");
    check_filter(num_vertices, labels);
    true
}

/// Whether entries and labels are ascending and in range, from the words; the length is right.
fn is_in_order(header: &CorrectionHeader, words: &[u32]) -> bool {
    let (entries, labels) = words.split_at(header.num_values as usize * ENTRY_WORDS);
    let entries: Vec<u32> = entries.chunks(ENTRY_WORDS).map(|entry| entry[0]).collect();
    let labels: Vec<[u32; 2]> = labels.as_chunks::<LABEL_WORDS>().0.to_vec();
    entries.windows(2).all(|pair| pair[0] < pair[1])
        && labels.windows(2).all(|pair| pair[0] < pair[1])
        && entries.iter().chain(labels.iter().map(|label| &label[0])).all(|&vertex| vertex < header.num_vertices)
}

/// A filter of labels against the definition, for the contacts of the first vertices. Labels of a session before are
/// forgotten.
fn check_filter(num_vertices: u32, labels: &[VertexLabel]) {
    let mut filter = ContactFilter::new(num_vertices as usize);
    filter.set((0..num_vertices).map(|vertex| (vertex, VertexLabel::ANY)));
    filter.set(labels.iter().map(|label| (label.vertex, label.label)));
    let of = |end: &[u32]| -> Vec<VertexLabel> {
        labels.iter().filter(|label| end.contains(&label.vertex)).copied().collect()
    };
    let is_off = |first: &[u32], second: &[u32]| {
        of(first).iter().any(|a| {
            of(second).iter().any(|b| {
                let any = [a, b].iter().any(|label| label.label == VertexLabel::ANY);
                any || a.pair() == b.pair() && a.side() | b.side() == VertexLabel::BOTH
            })
        })
    };
    // Also vertices that the filter has no room for.
    let ends = num_vertices.min(6) + 1;
    for a in 0..ends {
        for b in 0..ends {
            let face = [b, (b + 1) % ends, (b + 3) % ends];
            assert_eq!(filter.vertex_face_is_off(a, face), is_off(&[a], &face), "vertex {a}, face {face:?}");
            let edges = [[a, (a + 2) % ends], [b, (b + 1) % ends]];
            assert_eq!(filter.edge_edge_is_off(edges[0], edges[1]), is_off(&edges[0], &edges[1]), "edges {edges:?}");
        }
    }
}

/// Numbers of paths and points, one byte each, one byte of how far the payload is from where it should be, and the
/// payload. What is accepted comes back, and a path's points are among all points.
pub(super) fn paths(bytes: &[u8]) -> bool {
    let Some((&[num_paths, num_points, off], rest)) = bytes.split_first_chunk::<3>() else { return false };
    let header = PathsHeader { num_paths: num_paths.into(), num_points: num_points.into(), ..PathsHeader::default() };
    // Shared memory is aligned; what a peer says of its layout need not be true.
    let mut memory = vec![0; rest.len() + 16];
    let start = memory.as_ptr().align_offset(8) + usize::from(off % 8);
    memory[start..start + rest.len()].copy_from_slice(rest);
    let payload = &memory[start..start + rest.len()];
    let length = (header.num_paths as usize + header.num_points as usize) * 32;
    let Some((records, points)) = header.split(payload) else {
        assert!(payload.len() != length || off % 8 != 0, "what is right is accepted");
        return false;
    };
    assert_eq!(payload.len(), length, "what is accepted is right");
    let written = records.iter().flat_map(|record| PathRecord::to_bytes(*record));
    let written_points = points.iter().flat_map(|point| PathPoint::to_bytes(*point));
    assert!(written.chain(written_points).eq(payload.iter().copied()), "bytes come back");
    for record in records {
        let own = record.points(points);
        assert!(own.is_empty() || own.len() == record.num_points as usize);
        let fits = u64::from(record.first_point) + u64::from(record.num_points) <= points.len() as u64;
        assert_eq!(own.len(), if fits { record.num_points as usize } else { 0 }, "{record:?}");
    }
    true
}

/// Numbers of vertices and of the elements of each part, one byte each, and the payload of a view. What is accepted
/// comes back, and names nothing that is not there.
pub(super) fn view(bytes: &[u8]) -> bool {
    let Some((&[num_vertices, ref counts @ ..], rest)) = bytes.split_first_chunk::<7>() else { return false };
    let [num_paths, num_points, num_entries, num_positions, num_inside, num_depths] =
        counts.map(|count| if count == u8::MAX { u32::MAX } else { count.into() });
    let header = ViewHeader {
        num_paths,
        num_points,
        num_entries,
        num_positions,
        num_inside,
        num_depths,
        ..ViewHeader::default()
    };
    let mesh = ObservedMesh { num_vertices: num_vertices.into(), ..ObservedMesh::default() };
    let Ok(seen) = Observation::read(header, rest, &mesh) else { return false };
    let parts = header.split(rest).expect("what is accepted is as long as it says");
    let paths = parts.records().flat_map(PathRecord::to_bytes).chain(parts.points().flat_map(PathPoint::to_bytes));
    let words = parts.entries().flat_map(|entry| entry.to_words().map(u32::to_le_bytes)).flatten();
    let positions = parts.positions().flatten().flat_map(f32::to_le_bytes);
    let inside = parts.inside().flat_map(InsideEntry::to_bytes).chain(parts.depths().flat_map(f32::to_le_bytes));
    assert!(paths.chain(words).chain(positions).chain(inside).eq(rest.iter().copied()), "bytes come back");
    let num_pairs = seen.paths().records.iter().map(|record| record.pair as usize + 1).max().unwrap_or(0);
    assert!(num_pairs <= seen.paths().records.len());
    assert!(seen.depths_m.is_empty() || seen.depths_m.len() == num_pairs);
    assert!(seen.inside.iter().all(|own| own.vertex < num_vertices.into() && (own.pair as usize) < num_pairs));
    true
}
