//! The stages of a frame, and who is told of them.

/// The stages of a frame, in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Broad phase and edge-face tests.
    Intersect,
    /// Tracing and classification.
    Paths,
    /// Inside regions.
    Regions,
    /// Correspondence and targets.
    Correspond,
    /// Forces and flags.
    Respond,
}

/// Told when a stage begins, and asked whether to go on: how callers with a clock measure stages and end a frame early.
/// `()` ignores it and has all the time in the world.
pub trait StageObserver {
    /// `stage` begins now, and the one before it has ended.
    fn begin(&mut self, stage: Stage);
    /// The last stage has ended.
    fn end(&mut self);
    /// Whether the time for this frame is up. Asked before each pair of paths, the longest first; what comes after is
    /// left out.
    fn is_spent(&mut self) -> bool {
        false
    }
}

impl StageObserver for () {
    fn begin(&mut self, _: Stage) {}
    fn end(&mut self) {}
}
