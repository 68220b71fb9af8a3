//! Intersection paths of a frame: daemon to whoever listens, for pictures and statistics.
//!
//! The payload is bytes: [`PathsHeader::num_paths`] records, then [`PathsHeader::num_points`] points, without gaps.

use iceoryx2::prelude::ZeroCopySend;

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
    /// Zero.
    pub reserved: u32,
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

impl PathRecord {
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
            self.reserved,
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
