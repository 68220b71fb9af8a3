//! Intersection paths of a frame: daemon to each subscriber, for pictures and statistics.
//!
//! The payload is bytes: [`PathsHeader::num_paths`] records, then [`PathsHeader::num_points`] points, without gaps.

use iceoryx2_bb_derive_macros::ZeroCopySend;
use iceoryx2_bb_elementary_traits::zero_copy_send::ZeroCopySend;

/// Header of a frame's paths.
#[derive(Clone, Copy, Debug, Default, PartialEq, ZeroCopySend)]
#[repr(C)]
#[type_name("untangled.v1.PathsHeader")]
pub struct PathsHeader {
    /// The frame.
    pub frame: u64,
    /// Number of records.
    pub num_paths: u32,
    /// Number of points.
    pub num_points: u32,
    /// Zero.
    pub reserved: [u64; 6],
}

/// Types of paths after splitting: values of [`PathRecord::path_type`].
pub mod path_type {
    /// A loop without a loop vertex.
    pub const CLOSED: u32 = 0;
    /// A loop with two loop vertices.
    pub const LOOP_LOOP: u32 = 1;
    /// Boundary, loop vertex, inside.
    pub const BOUNDARY_LOOP_INSIDE: u32 = 2;
    /// Boundary, loop vertex, boundary.
    pub const BOUNDARY_LOOP_BOUNDARY: u32 = 3;
    /// Both ends on the boundary.
    pub const BOUNDARY_BOUNDARY: u32 = 4;
    /// One end on the boundary.
    pub const BOUNDARY_INSIDE: u32 = 5;
    /// No end on the boundary.
    pub const INSIDE_INSIDE: u32 = 6;
}

/// One path; little-endian, 32 bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C)]
pub struct PathRecord {
    /// Which pair it belongs to.
    pub pair: u32,
    /// [`pair_type`](crate::pair_type) of that pair.
    pub pair_type: u32,
    /// [`path_type`] of this path.
    pub path_type: u32,
    /// Index of the corresponding path; its own where it is its own.
    pub partner: u32,
    /// 1 for a loop on the cloth, else 0.
    pub closed: u32,
    /// Index of its first point.
    pub first_point: u32,
    /// Number of its points.
    pub num_points: u32,
    /// In a view what became of it, see [`path_state`](crate::view::path_state); zero in the paths that a host gets.
    pub state: u32,
}

/// One point; little-endian, 32 bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct PathPoint {
    /// World position in metres.
    pub position_m: [f64; 3],
    /// The face that the path runs through after this point, and the partner's; the last point repeats the last faces.
    pub faces: [u32; 2],
}

impl PathsHeader {
    /// Records and points of a payload, in place; nothing where its length or alignment is not what this header says.
    #[must_use]
    pub fn split<'a>(&self, payload: &'a [u8]) -> Option<(&'a [PathRecord], &'a [PathPoint])> {
        let (num_paths, num_points) = (self.num_paths as usize, self.num_points as usize);
        let records = payload.get(..num_paths.checked_mul(size_of::<PathRecord>())?)?;
        let points = &payload[records.len()..];
        // SAFETY: both structs are repr(C) of numbers only, without padding, so that any bytes are valid values; the
        // middle part that `align_to` finds is aligned.
        let (records, points) = unsafe { (records.align_to::<PathRecord>(), points.align_to::<PathPoint>()) };
        let whole = records.0.is_empty() && records.2.is_empty() && points.0.is_empty() && points.2.is_empty();
        (whole && records.1.len() == num_paths && points.1.len() == num_points).then_some((records.1, points.1))
    }
}

impl PathRecord {
    /// The points of this path among all points of the frame; none where the record points outside of them.
    #[must_use]
    pub fn points<'a>(&self, all: &'a [PathPoint]) -> &'a [PathPoint] {
        let first = self.first_point as usize;
        all.get(first..first.saturating_add(self.num_points as usize)).unwrap_or_default()
    }

    /// From its words on the wire.
    pub(super) fn from_words(words: [u32; 8]) -> Self {
        let [pair, pair_type, path_type, partner, closed, first_point, num_points, state] = words;
        Self { pair, pair_type, path_type, partner, closed, first_point, num_points, state }
    }

    /// The bytes on the wire.
    #[must_use]
    pub fn to_bytes(self) -> [u8; 32] {
        let words = [
            self.pair,
            self.pair_type,
            self.path_type,
            self.partner,
            self.closed,
            self.first_point,
            self.num_points,
            self.state,
        ];
        let mut bytes = [0; 32];
        for (slot, word) in bytes.chunks_exact_mut(4).zip(words) {
            slot.copy_from_slice(&word.to_le_bytes());
        }
        bytes
    }
}

impl PathPoint {
    /// The bytes on the wire.
    #[must_use]
    pub fn to_bytes(self) -> [u8; 32] {
        let mut bytes = [0; 32];
        for (slot, value) in bytes.chunks_exact_mut(8).zip(self.position_m) {
            slot.copy_from_slice(&value.to_le_bytes());
        }
        for (slot, value) in bytes[24..].chunks_exact_mut(4).zip(self.faces) {
            slot.copy_from_slice(&value.to_le_bytes());
        }
        bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn split_reads_paths_in_place_and_rejects_wrong_lengths() {
        #[repr(align(64))]
        struct Payload([u8; 128]);
        let record = PathRecord { pair: 7, first_point: 1, num_points: 2, ..PathRecord::default() };
        let point = |x| PathPoint { position_m: [x, 0.0, -1.0], faces: [3, 4] };
        let mut payload = Payload([0; 128]);
        payload.0[..32].copy_from_slice(&record.to_bytes());
        for k in 0..3u8 {
            let begin = 32 * usize::from(k + 1);
            payload.0[begin..begin + 32].copy_from_slice(&point(f64::from(k)).to_bytes());
        }
        let header = PathsHeader { num_paths: 1, num_points: 3, ..PathsHeader::default() };
        let (records, points) = header.split(&payload.0).unwrap();
        assert_eq!(records, [record]);
        assert_eq!(records[0].points(points), [point(1.0), point(2.0)]);
        assert_eq!(PathRecord { num_points: 3, ..record }.points(points), []);
        for lie in [PathsHeader { num_paths: 2, ..header }, PathsHeader { num_points: u32::MAX, ..header }] {
            assert_eq!(lie.split(&payload.0), None);
        }
        assert_eq!(header.split(&payload.0[1..]), None);
    }
}
