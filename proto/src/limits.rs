//! What a peer may ask for, and what it costs in shared memory.

use crate::{
    control::Precision,
    correction::{CorrectionHeader, VertexCorrection},
    state::{PositionF32, PositionF64, StateHeader},
};

/// Most sessions of one daemon.
pub const MAX_SESSIONS: usize = 64;
/// Most connected clients of one daemon; one client may hold several sessions.
pub const MAX_CLIENTS: usize = 64;
/// Most vertices of a session, unless the daemon's configuration says less.
pub const MAX_VERTICES: usize = 1 << 24;
/// Most faces of a session, unless the daemon's configuration says less.
pub const MAX_FACES: usize = 1 << 25;
/// Most sections of a request.
pub const MAX_SECTIONS: usize = 32;
/// Longest settings document in bytes.
pub const MAX_SETTINGS_BYTES: usize = 1 << 20;

/// Shortest step of a frame in seconds.
pub const MIN_DT_S: f64 = 1e-9;
/// Longest step of a frame in seconds.
pub const MAX_DT_S: f64 = 1e9;

/// Frames that wait for the daemon: the newest only.
pub const STATE_BUFFER: usize = 1;
/// States that the daemon holds at a time.
pub const STATE_BORROWED: usize = 1;
/// Corrections that wait for the host.
pub const CORRECTION_BUFFER: usize = 2;
/// Corrections that a host may hold at a time.
pub const CORRECTION_BORROWED: usize = 4;
/// Listeners to a session's paths.
pub const PATHS_SUBSCRIBERS: usize = 4;
/// Paths that a listener may hold at a time: those of all corrections that a host may hold.
pub const PATHS_BORROWED: usize = CORRECTION_BORROWED;
/// Alignment of positions and corrections in bytes.
pub const PAYLOAD_ALIGNMENT: usize = 64;

/// Room that iceoryx2 takes for each sample besides payload and user header, rounded up generously.
const CHUNK_OVERHEAD: u64 = 256;
/// Room for management data of a session's ports and services.
const SESSION_OVERHEAD: u64 = 1 << 20;

fn segment(num_elements: usize, element: usize, header: usize, num_chunks: usize) -> u64 {
    let bytes = (num_elements as u64).saturating_mul(element as u64);
    bytes.saturating_add(header as u64 + CHUNK_OVERHEAD).saturating_mul(num_chunks as u64)
}

/// Shared memory of a host's state publisher in bytes.
#[must_use]
pub fn state_segment_bytes(num_vertices: usize, precision: Precision) -> u64 {
    let element = match precision {
        Precision::F32 => size_of::<PositionF32>(),
        Precision::F64 => size_of::<PositionF64>(),
    };
    // One loan besides what the subscriber can have: buffered and borrowed.
    segment(num_vertices, element, size_of::<StateHeader>(), STATE_BUFFER + STATE_BORROWED + 1)
}

/// Shared memory of a session's correction publisher in bytes.
#[must_use]
pub fn correction_segment_bytes(num_vertices: usize) -> u64 {
    let num_chunks = CORRECTION_BUFFER + CORRECTION_BORROWED + 1;
    segment(num_vertices, size_of::<VertexCorrection>(), size_of::<CorrectionHeader>(), num_chunks)
}

/// Shared memory of a whole session in bytes, both sides together.
#[must_use]
pub fn session_bytes(num_vertices: usize, precision: Precision) -> u64 {
    state_segment_bytes(num_vertices, precision)
        .saturating_add(correction_segment_bytes(num_vertices))
        .saturating_add(SESSION_OVERHEAD)
}

/// Shared memory for one request of a client in bytes: its port keeps room for one loan and two requests on their way.
#[must_use]
pub fn request_segment_bytes(request_bytes: usize) -> u64 {
    segment(request_bytes, 1, 64, 3)
}
