//! Times of the stages of a frame.

use std::time::{Duration, Instant};

use untangled_proto::correction::stage;

use untangle::stage::{Stage, StageObserver};

/// Measures stages and the time budget of a frame. The library itself has no clock; it reports its stages to this
/// observer.
#[derive(Debug)]
pub(crate) struct StageClock {
    begin: Instant,
    running: Option<(usize, Instant)>,
    ns: [u64; 8],
    limit: Option<Duration>,
}

impl StageClock {
    /// Starts with [`stage::INGEST`]; the time budget of the frame ends after `limit`.
    pub(crate) fn start(limit: Option<Duration>) -> Self {
        let now = Instant::now();
        Self { begin: now, running: Some((stage::INGEST, now)), ns: [0; 8], limit }
    }

    /// The stage at this index begins, and the one before it has ended.
    pub(crate) fn begin_index(&mut self, index: usize) {
        let now = Instant::now();
        self.stop(now);
        self.running = Some((index, now));
    }

    /// Ends the last stage and returns the time of each, in nanoseconds.
    pub(crate) fn finish(&mut self) -> [u64; 8] {
        let now = Instant::now();
        self.stop(now);
        self.ns[stage::TOTAL] = nanoseconds(self.begin, now);
        self.ns
    }

    fn stop(&mut self, now: Instant) {
        if let Some((index, since)) = self.running.take() {
            self.ns[index] += nanoseconds(since, now);
        }
    }
}

impl StageObserver for StageClock {
    fn begin(&mut self, stage: Stage) {
        self.begin_index(match stage {
            Stage::Intersect => stage::INTERSECT,
            Stage::Paths => stage::PATHS,
            Stage::Regions => stage::REGIONS,
            Stage::Correspond => stage::CORRESPOND,
            Stage::Respond => stage::RESPOND,
        });
    }

    fn end(&mut self) {
        self.stop(Instant::now());
    }

    fn is_spent(&mut self) -> bool {
        self.limit.is_some_and(|limit| self.begin.elapsed() >= limit)
    }
}

fn nanoseconds(from: Instant, to: Instant) -> u64 {
    u64::try_from(to.saturating_duration_since(from).as_nanos()).unwrap_or(u64::MAX)
}
