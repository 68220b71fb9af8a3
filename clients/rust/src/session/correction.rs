//! A correction, read in place in shared memory.

use std::sync::{Arc, OnceLock};

use untangled_proto::{
    CorrectionHeader, Status, VertexCorrection, VertexEntry, VertexLabel,
    correction::{NO_FAULT, REPAIRING},
    flags, limits,
};

use super::{
    dense::{DenseView, DenseViews},
    paths::{Paths, PathsSample},
    samples::CorrectionSample,
};
use crate::error::FrameRefusal;

/// The correction of one frame. It stays in shared memory and readable until it is dropped, even if the daemon ends; a
/// session can hold [`CORRECTION_BORROWED`](untangled_proto::limits::CORRECTION_BORROWED) of them less one.
#[derive(Debug)]
pub struct Correction {
    header: CorrectionHeader,
    sample: CorrectionSample,
    paths: Option<PathsSample>,
    /// All vertices of a sparse correction, once they were asked for.
    dense: OnceLock<DenseView>,
    views: Arc<DenseViews>,
}

impl Correction {
    /// A sample as a correction, if the daemon could use the frame.
    pub(crate) fn new(
        sample: CorrectionSample,
        paths: Option<PathsSample>,
        views: Arc<DenseViews>,
    ) -> Result<Self, FrameRefusal> {
        let header = *sample.header();
        match refusal(&header) {
            None => Ok(Self { header, sample, paths, dense: OnceLock::new(), views }),
            Some(refusal) => Err(refusal),
        }
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
    ///
    /// Cost: nothing where the correction came so. Of a sparse one, linear in its entries at the first call, without an
    /// allocation once the session is warm.
    #[must_use]
    pub fn vertices(&self) -> &[VertexCorrection] {
        match &self.sample {
            CorrectionSample::Dense(sample) => sample.payload(),
            CorrectionSample::Sparse(sample) => {
                self.dense.get_or_init(|| DenseViews::view(&self.views, sample.entries())).vertices()
            }
        }
    }

    /// The vertices that have a value or a flag other than pinned, ascending, however the correction came.
    ///
    /// Cost: linear in the entries of a sparse correction, in the vertices of a dense one.
    pub fn entries(&self) -> impl Iterator<Item = VertexEntry> + '_ {
        let (dense, sparse) = match &self.sample {
            CorrectionSample::Dense(sample) => (sample.payload(), &[][..]),
            CorrectionSample::Sparse(sample) => (&[][..], sample.entries()),
        };
        let dense = (0..).zip(dense).filter(|(_, vertex)| is_entry(vertex));
        let dense = dense.map(|(vertex, &VertexCorrection { value, flags })| VertexEntry { vertex, value, flags });
        dense.chain(sparse.iter().copied())
    }

    /// The [`entries`](Self::entries) of a sparse correction, in place; nothing of a dense one.
    #[must_use]
    pub fn sparse(&self) -> Option<&[VertexEntry]> {
        match &self.sample {
            CorrectionSample::Dense(_) => None,
            CorrectionSample::Sparse(sample) => Some(sample.entries()),
        }
    }

    /// Labels of vertices, ascending: which contacts have to be off. Empty where none were asked for, or where the
    /// daemon is too old for them: see [`Session::has_labels`](crate::Session::has_labels).
    #[must_use]
    pub fn labels(&self) -> &[VertexLabel] {
        match &self.sample {
            CorrectionSample::Dense(_) => &[],
            CorrectionSample::Sparse(sample) => sample.labels(),
        }
    }

    /// The intersection paths of the frame. Nothing where they were not asked for at registration, or where shared
    /// memory did not hold them.
    #[must_use]
    pub fn paths(&self) -> Option<Paths<'_>> {
        self.paths.as_ref().and_then(PathsSample::paths)
    }
}

fn is_entry(vertex: &VertexCorrection) -> bool {
    vertex.flags & !flags::PINNED != 0 || vertex.value.iter().any(|value| value.to_bits() != 0)
}

/// Why a frame was not corrected, if it was not.
pub(crate) fn refusal(header: &CorrectionHeader) -> Option<FrameRefusal> {
    (header.status != Status::Ok.code()).then(|| FrameRefusal {
        frame: header.frame,
        status: Status::from_code(header.status).unwrap_or(Status::Internal),
        fault_index: Some(header.fault_index).filter(|&index| index != NO_FAULT),
        fault_value: header.fault_value,
        header_field: field_at_fault(header),
    })
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
