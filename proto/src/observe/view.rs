//! A view of a frame: daemon to each observer, after the correction of the frame has gone out.
//!
//! The payload is bytes without gaps: [`ViewHeader::num_paths`] records and [`ViewHeader::num_points`] points as in
//! [`paths`](super::paths), then [`ViewHeader::num_entries`] entries of 20 bytes as in a sparse correction, then
//! [`ViewHeader::num_positions`] positions of three `f32` in metres, then [`ViewHeader::num_inside`] vertices inside
//! with their pairs, then [`ViewHeader::num_depths`] depths of pairs.

use iceoryx2_bb_derive_macros::ZeroCopySend;
use iceoryx2_bb_elementary_traits::zero_copy_send::ZeroCopySend;

use super::paths::{PathPoint, PathRecord};
use crate::correction::{CorrectionHeader, VertexEntry};

/// Header of a view.
#[derive(Clone, Copy, Debug, Default, PartialEq, ZeroCopySend)]
#[repr(C)]
#[type_name("untangled.v1.ViewHeader")]
pub struct ViewHeader {
    /// The header of the frame's correction, as the host got it.
    pub correction: CorrectionHeader,
    /// Frames of the session that were answered so far, this one included: an observer sees by it how many it missed.
    pub num_frames: u64,
    /// When the correction had been sent: nanoseconds of `CLOCK_MONOTONIC` on the daemon's machine.
    pub sent_ns: u64,
    /// Number of records of paths.
    pub num_paths: u32,
    /// Number of points of paths.
    pub num_points: u32,
    /// Number of vertices that have a value or a flag other than pinned.
    pub num_entries: u32,
    /// Number of positions: that of the vertices, or 0 where the positions of the frame can't be used.
    pub num_positions: u32,
    /// Number of vertices inside, each as often as there are pairs of paths that it is inside of.
    pub num_inside: u32,
    /// Number of depths: that of the pairs, or 0.
    pub num_depths: u32,
    /// Zero.
    pub reserved: [u64; 3],
}

/// A vertex inside of a pair of paths; little-endian, 8 bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C)]
pub struct InsideEntry {
    /// Index of the vertex.
    pub vertex: u32,
    /// The pair, as in [`PathRecord::pair`].
    pub pair: u32,
}

impl InsideEntry {
    /// The bytes on the wire.
    #[must_use]
    pub fn to_bytes(self) -> [u8; 8] {
        (u64::from(self.pair) << 32 | u64::from(self.vertex)).to_le_bytes()
    }
}

/// What became of a path in its frame: values of [`PathRecord::state`] in a view.
pub mod path_state {
    /// Not said, as in the paths that a host gets.
    pub const UNKNOWN: u32 = 0;
    /// Its pair has vertices inside.
    pub const REGION: u32 = 1;
    /// Its pair has none: nothing separates, no vertex is inside, or the paths have one end inside only.
    pub const NO_REGION: u32 = 2;
    /// Time was up before its pair was worked on: it has flags near the path only.
    pub const LEFT_OUT: u32 = 3;

    /// Their names, by value.
    pub const NAMES: [&str; 4] = ["unknown", "region", "no region", "left out"];
}

/// Bytes of an entry.
pub const ENTRY_BYTES: usize = 20;
/// Bytes of a position.
pub const POSITION_BYTES: usize = 12;
/// Bytes of a depth.
pub const DEPTH_BYTES: usize = 4;

/// The parts of a payload, each of elements that lie one after the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ViewParts<'a> {
    records: &'a [u8],
    points: &'a [u8],
    entries: &'a [u8],
    positions: &'a [u8],
    inside: &'a [u8],
    depths: &'a [u8],
}

impl ViewHeader {
    /// The parts of a payload; nothing where its length is not what this header says.
    #[must_use]
    pub fn split<'a>(&self, payload: &'a [u8]) -> Option<ViewParts<'a>> {
        let parts = [
            (self.num_paths, size_of::<PathRecord>()),
            (self.num_points, size_of::<PathPoint>()),
            (self.num_entries, ENTRY_BYTES),
            (self.num_positions, POSITION_BYTES),
            (self.num_inside, size_of::<InsideEntry>()),
            (self.num_depths, DEPTH_BYTES),
        ];
        let mut rest = payload;
        let mut found = [&payload[..0]; 6];
        for ((count, bytes), part) in parts.into_iter().zip(&mut found) {
            let length = usize::try_from(count).ok()?.checked_mul(bytes)?;
            (*part, rest) = rest.split_at_checked(length)?;
        }
        let [records, points, entries, positions, inside, depths] = found;
        rest.is_empty().then_some(ViewParts { records, points, entries, positions, inside, depths })
    }
}

impl<'a> ViewParts<'a> {
    /// The records of paths.
    pub fn records(self) -> impl ExactSizeIterator<Item = PathRecord> + 'a {
        elements(self.records, |words| PathRecord::from_words(words.map(u32::from_le_bytes)))
    }

    /// The points of all paths.
    pub fn points(self) -> impl ExactSizeIterator<Item = PathPoint> + 'a {
        elements(self.points, |words: [[u8; 8]; 4]| {
            let [x, y, z, faces] = words;
            let faces = u64::from_le_bytes(faces);
            #[expect(clippy::cast_possible_truncation, reason = "the lower half is the first face")]
            let faces = [faces as u32, (faces >> 32) as u32];
            PathPoint { position_m: [x, y, z].map(f64::from_le_bytes), faces }
        })
    }

    /// What is said of vertices, ascending by vertex where the daemon keeps to the protocol.
    pub fn entries(self) -> impl ExactSizeIterator<Item = VertexEntry> + 'a {
        elements(self.entries, |words| {
            let [vertex, x, y, z, flags] = words.map(u32::from_le_bytes);
            VertexEntry { vertex, value: [x, y, z].map(f32::from_bits), flags }
        })
    }

    /// The positions, in metres.
    pub fn positions(self) -> impl ExactSizeIterator<Item = [f32; 3]> + 'a {
        elements(self.positions, |words| words.map(f32::from_le_bytes))
    }

    /// The vertices inside, by pair.
    pub fn inside(self) -> impl ExactSizeIterator<Item = InsideEntry> + 'a {
        elements(self.inside, |words| {
            let [vertex, pair] = words.map(u32::from_le_bytes);
            InsideEntry { vertex, pair }
        })
    }

    /// For each pair how far the farthest point inside is from where it should be, in metres; 0 where nothing inside
    /// has such a place.
    pub fn depths(self) -> impl ExactSizeIterator<Item = f32> + 'a {
        elements(self.depths, |[depth]| f32::from_le_bytes(depth))
    }
}

/// Elements of `N` words each.
fn elements<'a, T, const BYTES: usize, const N: usize>(
    bytes: &'a [u8],
    read: impl Fn([[u8; BYTES]; N]) -> T + 'a,
) -> impl ExactSizeIterator<Item = T> + 'a {
    let word = |bytes: &[u8], k: usize| std::array::from_fn(|byte| bytes[BYTES * k + byte]);
    bytes.chunks_exact(BYTES * N).map(move |bytes| read(std::array::from_fn(|k| word(bytes, k))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn split_reads_what_was_written_and_rejects_other_lengths() {
        let record = PathRecord { pair: 7, num_points: 1, state: path_state::LEFT_OUT, ..PathRecord::default() };
        let point = PathPoint { position_m: [1.0, -2.0, 0.5], faces: [3, 4] };
        let entry = VertexEntry { vertex: 5, value: [0.25, -1.0, 4.0], flags: 3 };
        let position = [1.5f32, -0.5, 8.0];
        let mut payload = [record.to_bytes(), point.to_bytes()].concat();
        payload.extend(entry.to_words().iter().flat_map(|word| word.to_le_bytes()));
        payload.extend(position.iter().flat_map(|value| value.to_le_bytes()));
        let inside = [InsideEntry { vertex: 5, pair: 7 }, InsideEntry { vertex: u32::MAX, pair: 1 }];
        payload.extend(inside.map(InsideEntry::to_bytes).as_flattened());
        payload.extend(0.125f32.to_le_bytes());
        let header = ViewHeader {
            num_paths: 1,
            num_points: 1,
            num_entries: 1,
            num_positions: 1,
            num_inside: 2,
            num_depths: 1,
            ..ViewHeader::default()
        };
        let parts = header.split(&payload).unwrap();
        assert_eq!(parts.records().collect::<Vec<_>>(), [record]);
        assert_eq!(parts.points().collect::<Vec<_>>(), [point]);
        assert_eq!(parts.entries().collect::<Vec<_>>(), [entry]);
        assert_eq!(parts.positions().collect::<Vec<_>>(), [position]);
        assert_eq!(parts.inside().collect::<Vec<_>>(), inside);
        assert_eq!(parts.depths().collect::<Vec<_>>(), [0.125]);
        assert_eq!(header.split(&payload[1..]), None);
        for lie in [
            ViewHeader { num_positions: 2, ..header },
            ViewHeader { num_entries: 0, ..header },
            ViewHeader { num_inside: 3, ..header },
            ViewHeader { num_depths: 0, ..header },
            ViewHeader { num_points: u32::MAX, ..header },
        ] {
            assert_eq!(lie.split(&payload), None);
        }
    }
}
