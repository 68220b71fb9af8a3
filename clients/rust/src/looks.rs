//! Waiting for an event that may never come although what it tells of has.
//!
//! A notifier of iceoryx2 0.10 that is interrupted while the listener drains its events leaves the listener marked as notified with
//! nothing to wake it, and later notifications trust that mark. A listener that waits anew finds it out: so it looks soon, and then at
//! longer and longer intervals.

use std::time::Duration;

use iceoryx2::port::listener::Listener;
use untangled_transport::services::Ipc;

/// The longest time between two looks.
pub(crate) const SLICE: Duration = Duration::from_millis(50);
const FIRST: Duration = Duration::from_millis(1);
const GROWTH: u32 = 4;

/// The looks of one wait.
#[derive(Debug)]
pub(crate) struct Looks(Duration);

impl Looks {
    pub(crate) fn new() -> Self {
        Self(FIRST)
    }

    /// Sleeps until an event comes or it is time to look, at most so long.
    pub(crate) fn sleep(&mut self, listener: &Listener<Ipc>, most: Duration) {
        // An interrupted wait is a shorter one, and one of less than a microsecond would be one without end.
        let _ = listener.timed_wait(|_| {}, most.min(self.0).max(Duration::from_micros(1)));
        self.0 = (GROWTH * self.0).min(SLICE);
    }
}
