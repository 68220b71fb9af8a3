//! The last of a sample: its header.

use untangled_proto::CorrectionHeader;

use crate::service::session::clock::StageClock;

/// Writes the header of a sample last, with the times so far, and has it counted before the sample is sent, so that a
/// host that has the correction finds it counted.
pub(super) struct Finish<'a, R> {
    pub(super) header: &'a mut CorrectionHeader,
    pub(super) clock: &'a mut StageClock,
    pub(super) record: R,
}

impl<R: FnOnce(&CorrectionHeader)> Finish<'_, R> {
    /// The header to be written into the sample.
    pub(super) fn header(self) -> CorrectionHeader {
        self.header.stage_ns = self.clock.finish();
        (self.record)(self.header);
        *self.header
    }
}
