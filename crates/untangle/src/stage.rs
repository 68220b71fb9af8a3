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
    /// Whether the time for this frame is up. Asked every few milliseconds of the search and of the tracing of paths,
    /// which then find nothing, and before each pair of paths, the longest first; then this pair and all later ones are
    /// left out.
    fn is_spent(&mut self) -> bool {
        false
    }
}

impl StageObserver for () {
    fn begin(&mut self, _: Stage) {}
    fn end(&mut self) {}
}

/// Work between two questions, in units of about ten nanoseconds. Less is never interrupted.
const WORK_BETWEEN_QUESTIONS: usize = 1 << 18;

/// Asks an observer whether time is up, every few milliseconds of a long piece of work.
pub(crate) struct Pace<'a> {
    observer: &'a mut dyn StageObserver,
    work: usize,
}

impl<'a> Pace<'a> {
    pub(crate) fn new(observer: &'a mut dyn StageObserver) -> Self {
        Self { observer, work: 0 }
    }

    /// Whether time is up, after work of so many units of about ten nanoseconds.
    pub(crate) fn is_spent_after(&mut self, work: usize) -> bool {
        self.work += work;
        if self.work < WORK_BETWEEN_QUESTIONS {
            return false;
        }
        self.work = 0;
        self.observer.is_spent()
    }
}
