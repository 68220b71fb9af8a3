//! The requests of one session for repairs: which waits, and whether one is in work.

use std::{
    sync::atomic::{AtomicU64, Ordering},
    time::{Duration, Instant},
};

use serde::Serialize;
use untangle::intersect::SearchLimits;

/// A frame that is to be repaired.
#[derive(Debug)]
pub(super) struct Request {
    pub(super) frame: u64,
    pub(super) simulated_s: f64,
    /// `num_vertices x 3` in metres.
    pub(super) positions: Vec<[f64; 3]>,
    pub(super) limits: SearchLimits,
    /// Most time from `asked` on.
    pub(super) time: Option<Duration>,
    pub(super) asked: Instant,
}

/// What waits and what is in work of one session.
#[derive(Debug, Default)]
pub(super) struct State {
    /// The newest request that is not in work.
    pub(super) waiting: Option<Request>,
    /// Whether a repair is worked on, not sent yet.
    pub(super) is_working: bool,
    /// Whether a job of this session is queued or in work.
    pub(super) has_job: bool,
    pub(super) counts: Counts,
}

impl State {
    /// Takes the request that waits, to work on it.
    pub(super) fn begin(&mut self) -> Option<Request> {
        let request = self.waiting.take();
        self.is_working = request.is_some();
        request
    }

    /// Whether a repair is worked on or waits. Not while one is on its way out: the next frame of a host that has it
    /// may need one again.
    pub(super) fn is_busy(&self) -> bool {
        self.is_working || self.waiting.is_some()
    }

    /// Ends a job; whether another request waits, for which it goes on.
    pub(super) fn goes_on(&mut self) -> bool {
        self.has_job = self.waiting.is_some();
        self.has_job
    }
}

/// Counts of a session's repairs since it was registered.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub(crate) struct Counts {
    /// Repairs that were sent.
    pub(crate) num_sent: u64,
    /// Those of them that are certified.
    pub(crate) num_certified: u64,
    /// Requests that a newer one replaced while they waited.
    pub(crate) num_replaced: u64,
}

/// Counts of the repairs of all sessions since the daemon started, those that have ended included: they never fall.
#[derive(Debug, Default)]
pub(crate) struct Totals {
    num_sent: AtomicU64,
    num_certified: AtomicU64,
    num_replaced: AtomicU64,
}

impl Totals {
    /// Counts a repair that is sent.
    pub(super) fn add_sent(&self, is_certified: bool) {
        self.num_sent.fetch_add(1, Ordering::Relaxed);
        self.num_certified.fetch_add(u64::from(is_certified), Ordering::Relaxed);
    }

    /// Counts a request that a newer one replaced.
    pub(super) fn add_replaced(&self) {
        self.num_replaced.fetch_add(1, Ordering::Relaxed);
    }

    /// The counts now.
    pub(crate) fn counts(&self) -> Counts {
        let count = |count: &AtomicU64| count.load(Ordering::Relaxed);
        let (num_sent, num_certified) = (count(&self.num_sent), count(&self.num_certified));
        Counts { num_sent, num_certified, num_replaced: count(&self.num_replaced) }
    }
}

#[cfg(test)]
mod tests {
    use untangle::settings::Settings;

    use super::*;

    fn request() -> Request {
        let (positions, limits) = (Vec::new(), SearchLimits::new(&Settings::default(), 1));
        Request { frame: 1, simulated_s: 0.0, positions, limits, time: None, asked: Instant::now() }
    }

    #[test]
    fn state_whose_repair_is_on_its_way_out_takes_the_next_request_for_the_same_job() {
        let mut state = State { waiting: Some(request()), has_job: true, ..State::default() };
        assert!(state.is_busy());
        assert!(state.begin().is_some() && state.is_busy());
        state.is_working = false;
        assert!(!state.is_busy() && state.has_job, "a host that has the repair may need another one");
        state.waiting = Some(request());
        assert!(state.goes_on() && state.is_busy());
        assert!(state.begin().is_some());
        state.is_working = false;
        assert!(!state.goes_on() && !state.is_busy());
    }
}
