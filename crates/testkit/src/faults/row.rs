//! A row of the fault table.

/// A row of the fault table.
#[derive(Clone, Debug, Default)]
pub struct Row {
    /// The fault.
    pub what: String,
    /// How often it was tried.
    pub num_tries: u64,
    /// Frames that living clients exchanged meanwhile, each compared with the library's answer bit by bit.
    pub num_frames: u64,
    /// Frames with a wrong answer.
    pub num_wrong: u64,
    /// Frames of living clients without an answer that was due: not counted while their daemon is dead.
    pub num_lost: u64,
    /// What else was seen.
    pub note: String,
}

impl Row {
    /// Whether nothing was wrong and nothing was lost.
    pub fn is_clean(&self) -> bool {
        self.num_wrong == 0 && self.num_lost == 0
    }
}
