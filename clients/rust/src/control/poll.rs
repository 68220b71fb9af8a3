//! Polling of an event that may be lost.
//!
//! A notifier of iceoryx2 0.10 that is interrupted while the listener drains its events leaves the listener marked as
//! notified with nothing to wake it, and later notifications trust that mark. A new wait of the listener clears it. So
//! a wait is a sequence of short waits, each longer than the one before.

use std::time::{Duration, Instant};

use iceoryx2::port::listener::Listener;
use untangled_transport::services::Ipc;

/// The longest of the short waits.
pub(crate) const SLICE: Duration = Duration::from_millis(50);
const FIRST: Duration = Duration::from_millis(1);
const GROWTH: u32 = 4;

/// The instant so much later; a time that is too long for the clock's numbers ends in a year.
pub(crate) fn deadline_in(time: Duration) -> Instant {
    const YEAR: Duration = Duration::from_secs(31_536_000);
    let now = Instant::now();
    now.checked_add(time).unwrap_or(now + YEAR)
}

/// The length of the next short wait.
#[derive(Debug)]
pub struct Backoff(Duration);

impl Default for Backoff {
    fn default() -> Self {
        Self::new()
    }
}

impl Backoff {
    /// The first one.
    #[must_use]
    pub fn new() -> Self {
        Self(FIRST)
    }

    /// Sleeps until an event comes or the short wait is over, at most for `most`.
    pub fn sleep(&mut self, listener: &Listener<Ipc>, most: Duration) {
        // An interrupted wait is a shorter one. A wait of less than a microsecond would never end.
        let _ = listener.timed_wait(|_| {}, most.min(self.0).max(Duration::from_micros(1)));
        self.0 = (GROWTH * self.0).min(SLICE);
    }
}
