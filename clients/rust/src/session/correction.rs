//! A correction, read in place in shared memory.

use iceoryx2::sample::Sample;
use untangled_proto::{
    CorrectionHeader, Status, VertexCorrection,
    correction::{NO_FAULT, REPAIRING},
    limits,
};
use untangled_transport::services::Ipc;

use super::paths::{Paths, PathsSample};
use crate::error::FrameRefusal;

pub(crate) type CorrectionSample = Sample<Ipc, [VertexCorrection], CorrectionHeader>;

/// The correction of one frame. It stays in shared memory and readable until it is dropped, even if the daemon ends; a
/// session can hold [`CORRECTION_BORROWED`](untangled_proto::limits::CORRECTION_BORROWED) of them less one.
#[derive(Debug)]
pub struct Correction {
    header: CorrectionHeader,
    sample: CorrectionSample,
    paths: Option<PathsSample>,
}

impl Correction {
    /// A sample as a correction, if the daemon could use the frame.
    pub(crate) fn new(sample: CorrectionSample, paths: Option<PathsSample>) -> Result<Self, FrameRefusal> {
        let header = *sample.user_header();
        if header.status == Status::Ok.code() {
            return Ok(Self { header, sample, paths });
        }
        Err(FrameRefusal {
            frame: header.frame,
            status: Status::from_code(header.status).unwrap_or(Status::Internal),
            fault_index: Some(header.fault_index).filter(|&index| index != NO_FAULT),
            fault_value: header.fault_value,
            header_field: field_at_fault(&header),
        })
    }

    /// The frame that it is for.
    #[must_use]
    pub fn frame(&self) -> u64 {
        self.header.frame
    }

    /// Counts, times, and the force and torque left over.
    #[must_use]
    pub fn header(&self) -> &CorrectionHeader {
        &self.header
    }

    /// Whether a repair of the frame is going to come: see [`Session::wait_repair`](super::Session::wait_repair).
    #[must_use]
    pub fn is_being_repaired(&self) -> bool {
        self.header.flags & REPAIRING != 0
    }

    /// Value and flags of each vertex, `num_vertices`.
    #[must_use]
    pub fn vertices(&self) -> &[VertexCorrection] {
        self.sample.payload()
    }

    /// The intersection paths of the frame. Nothing where they were not asked for at registration, or where shared
    /// memory did not hold them.
    #[must_use]
    pub fn paths(&self) -> Option<Paths<'_>> {
        self.paths.as_ref().and_then(PathsSample::paths)
    }
}

/// The field of the state's header at fault, which the daemon sends back beside the value.
fn field_at_fault(header: &CorrectionHeader) -> Option<&'static str> {
    if header.status != Status::BadHeader.code() {
        None
    } else if !(limits::MIN_DT_S..=limits::MAX_DT_S).contains(&header.dt_s) {
        Some("dt_s")
    } else if !header.simulated_s.is_finite() {
        Some("simulated_s")
    } else {
        Some("num_vertices")
    }
}
