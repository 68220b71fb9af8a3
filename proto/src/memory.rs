//! Shared memory in bytes: what iceoryx2 0.10 makes of a port's element type, headers and number of samples.
//!
//! A port has one segment. It holds a fixed number of samples of equal size, each with iceoryx2's own header, the user
//! header and the payload, and a few bytes for each sample besides. `crates/transport/tests/segments.rs` compares these
//! formulas with segments as they are made.

use crate::{
    control::{Precision, ReplyHeader, RequestHeader, SessionOptions},
    correction::{CorrectionHeader, VertexCorrection, sparse},
    limits::{CORRECTION_BORROWED, CORRECTION_BUFFER, REPAIR_BORROWED, REPAIR_BUFFER, STATE_BORROWED, STATE_BUFFER},
    observe::{
        paths::PathsHeader,
        view::{ENTRY_BYTES, POSITION_BYTES, ViewHeader},
    },
    repair::RepairHeader,
    state::{PositionF32, PositionF64, StateHeader},
};

/// How the elements of a payload lie in shared memory.
///
/// iceoryx2 0.10 pads each element, not only the sample, to the payload alignment that a service asks for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PayloadLayout {
    /// One after the other, with the alignment of their type. The first lies on a multiple of 8 bytes.
    #[default]
    Packed,
    /// Room for a multiple of [`PADDED_ALIGNMENT`] bytes for each, and the first on such a multiple. The elements
    /// themselves lie one after the other here too; the rest of the room is not used. Clients of release 0.1 ask for
    /// this alignment, and can't open a service without it.
    Padded,
}

/// Payload alignment of [`PayloadLayout::Padded`] in bytes.
pub const PADDED_ALIGNMENT: usize = 64;

/// iceoryx2's header of a sample, before the user header.
const SAMPLE_HEADER: usize = 48;
/// iceoryx2's header of a request, before the user header.
const REQUEST_HEADER: usize = 64;
/// iceoryx2's header of a reply, before the user header.
const REPLY_HEADER: usize = 56;
/// Alignment of all headers.
const HEADER_ALIGNMENT: usize = 8;
/// What iceoryx2 keeps in each segment, and for each sample in it.
const SEGMENT_OVERHEAD: u64 = 512;
const SAMPLE_OVERHEAD: u64 = 8;
/// A segment takes whole pages.
const PAGE: u64 = 4096;

/// Samples of a state publisher: one being written besides what the daemon can have, waiting and held.
pub const STATE_SAMPLES: usize = STATE_BUFFER + STATE_BORROWED + 1;
/// Samples of a correction publisher: one being written besides what the host can have, waiting and held.
pub const CORRECTION_SAMPLES: usize = CORRECTION_BUFFER + CORRECTION_BORROWED + 1;
/// Samples of a repair publisher: one being written besides what the host can have, waiting and held.
pub const REPAIR_SAMPLES: usize = REPAIR_BUFFER + REPAIR_BORROWED + 1;
/// Samples of a request port of the clients here, which sends one request. iceoryx2 makes 3 unless told otherwise.
pub const REQUEST_SAMPLES: usize = 1;

/// Room for what iceoryx2 keeps of a session's services, ports and connections, both sides together.
const SESSION_OVERHEAD: u64 = 1 << 18;

/// The parts of a sample that do not depend on its length.
struct Sample {
    header: usize,
    user_header: usize,
    element: usize,
    alignment: usize,
}

impl Sample {
    const fn new<E, H>(header: usize) -> Self {
        Self { header, user_header: size_of::<H>(), element: size_of::<E>(), alignment: align_of::<E>() }
    }

    /// Bytes of a sample of `num_elements`.
    fn bytes(&self, num_elements: usize, layout: PayloadLayout) -> u64 {
        let alignment = match layout {
            PayloadLayout::Packed => self.alignment,
            PayloadLayout::Padded => self.alignment.max(PADDED_ALIGNMENT),
        };
        let headers = (self.header + self.user_header).next_multiple_of(alignment) as u64;
        let payload = (self.element.next_multiple_of(alignment) as u64).saturating_mul(num_elements as u64);
        round_up(headers.saturating_add(payload), alignment.max(HEADER_ALIGNMENT) as u64)
    }

    /// Bytes of a segment of so many samples.
    fn segment(&self, num_elements: usize, layout: PayloadLayout, num_samples: usize) -> u64 {
        let sample = self.bytes(num_elements, layout).saturating_add(SAMPLE_OVERHEAD);
        round_up(sample.saturating_mul(num_samples as u64).saturating_add(SEGMENT_OVERHEAD), PAGE)
    }
}

fn round_up(bytes: u64, unit: u64) -> u64 {
    bytes.checked_next_multiple_of(unit).unwrap_or(u64::MAX)
}

/// Shared memory of a host's state publisher in bytes.
#[must_use]
pub fn state_segment_bytes(num_vertices: usize, precision: Precision, layout: PayloadLayout) -> u64 {
    let sample = match precision {
        Precision::F32 => Sample::new::<PositionF32, StateHeader>(SAMPLE_HEADER),
        Precision::F64 => Sample::new::<PositionF64, StateHeader>(SAMPLE_HEADER),
    };
    sample.segment(num_vertices, layout, STATE_SAMPLES)
}

/// Words of the longest sparse correction: an entry for each vertex and, where labels are asked for, as many labels.
/// A correction with fewer entries has room for more labels.
#[must_use]
pub fn sparse_words(num_vertices: usize, options: SessionOptions) -> usize {
    let label = if options.has_labels() { sparse::LABEL_WORDS } else { 0 };
    num_vertices.saturating_mul(sparse::ENTRY_WORDS + label)
}

/// Shared memory of a session's correction publisher in bytes. Sparse corrections are packed in every layout: no client
/// of release 0.1 asks for them.
#[must_use]
pub fn correction_segment_bytes(num_vertices: usize, layout: PayloadLayout, options: SessionOptions) -> u64 {
    if options.is_sparse() {
        let sample = Sample::new::<u32, CorrectionHeader>(SAMPLE_HEADER);
        return sample.segment(sparse_words(num_vertices, options), PayloadLayout::Packed, CORRECTION_SAMPLES);
    }
    let sample = Sample::new::<VertexCorrection, CorrectionHeader>(SAMPLE_HEADER);
    sample.segment(num_vertices, layout, CORRECTION_SAMPLES)
}

/// Shared memory of a session's repair publisher in bytes, for sessions that asked for repairs.
#[must_use]
pub fn repair_segment_bytes(num_vertices: usize, precision: Precision, layout: PayloadLayout) -> u64 {
    let sample = match precision {
        Precision::F32 => Sample::new::<PositionF32, RepairHeader>(SAMPLE_HEADER),
        Precision::F64 => Sample::new::<PositionF64, RepairHeader>(SAMPLE_HEADER),
    };
    sample.segment(num_vertices, layout, REPAIR_SAMPLES)
}

/// Shared memory of a session in bytes, both sides together, without its request and its paths.
#[must_use]
pub fn session_bytes(num_vertices: usize, precision: Precision, layout: PayloadLayout, options: SessionOptions) -> u64 {
    let repairs = if options.has_repairs() { repair_segment_bytes(num_vertices, precision, layout) } else { 0 };
    state_segment_bytes(num_vertices, precision, layout)
        .saturating_add(correction_segment_bytes(num_vertices, layout, options))
        .saturating_add(repairs)
        .saturating_add(SESSION_OVERHEAD)
}

/// Shared memory of a request port for one request of so many bytes; freed after the reply.
#[must_use]
pub fn request_segment_bytes(request_bytes: usize, layout: PayloadLayout) -> u64 {
    Sample::new::<u8, RequestHeader>(REQUEST_HEADER).segment(request_bytes.max(1), layout, REQUEST_SAMPLES)
}

/// Bytes of one reply in the daemon's segment, with room for `length` bytes of payload.
#[must_use]
pub fn reply_sample_bytes(length: usize, layout: PayloadLayout) -> u64 {
    Sample::new::<u8, ReplyHeader>(REPLY_HEADER).bytes(length, layout)
}

/// Bytes of the paths of one frame in a session's segment, with room for `length` bytes of payload.
#[must_use]
pub fn paths_sample_bytes(length: usize, layout: PayloadLayout) -> u64 {
    Sample::new::<u8, PathsHeader>(SAMPLE_HEADER).bytes(length, layout)
}

/// Room for paths in the first samples of views. Longer ones make the samples grow.
const VIEW_PATHS_BYTES: usize = 1 << 16;

/// Length of the first samples of a session's views: all positions, an entry for each vertex, and some paths.
#[must_use]
pub fn view_bytes(num_vertices: usize) -> usize {
    num_vertices.saturating_mul(POSITION_BYTES + ENTRY_BYTES).saturating_add(VIEW_PATHS_BYTES)
}

/// Bytes of one view in a session's segment, with room for `length` bytes of payload. Views are packed in every layout.
#[must_use]
pub fn view_sample_bytes(length: usize) -> u64 {
    Sample::new::<u8, ViewHeader>(SAMPLE_HEADER).bytes(length, PayloadLayout::Packed)
}
