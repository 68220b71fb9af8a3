//! The stages of a frame, and the observer that is told of them.

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

/// Is told when a stage begins, and asked whether time is up: so callers with a clock measure stages and end a frame
/// early. `()` measures nothing and never ends a frame.
pub trait StageObserver {
    /// `stage` begins now, and the one before it has ended.
    fn begin(&mut self, stage: Stage);
    /// The last stage has ended.
    fn end(&mut self);
    /// Whether the time for this frame is up. Asked before each pair of paths, the longest first; if so, this pair and
    /// all later ones are left out.
    fn is_spent(&mut self) -> bool {
        false
    }
}

impl StageObserver for () {
    fn begin(&mut self, _: Stage) {}
    fn end(&mut self) {}
}
