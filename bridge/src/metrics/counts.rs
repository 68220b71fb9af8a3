//! The counts.

use std::{
    sync::atomic::{AtomicU64, Ordering},
    time::{Duration, Instant},
};

use serde_json::{Value, json};

use super::histogram::Histogram;

/// Counts of an end since its start. All threads add to them.
#[derive(Debug)]
pub struct Metrics {
    started: Instant,
    /// Messages with a frame that left, and their bytes.
    pub sent: Flow,
    /// Messages with a frame that came, and their bytes.
    pub received: Flow,
    /// Messages that were sent again, since a connection broke before the other end had them.
    pub num_sent_again: AtomicU64,
    /// Frames that a newer one overtook before they left.
    pub num_overtaken: AtomicU64,
    /// Messages that were dropped: of a wrong session or frame, twice, late, malformed.
    pub num_rejected: AtomicU64,
    /// Requests that were passed on.
    pub num_requests: AtomicU64,
    /// Requests that this end refused itself.
    pub num_refused_requests: AtomicU64,
    /// Sessions that ended because the other end or the daemon went away.
    pub num_lost_sessions: AtomicU64,
    /// Time from a message's leaving to its acknowledgement.
    pub round_trips: Histogram,
}

/// Messages and bytes in one direction.
#[derive(Debug, Default)]
pub struct Flow {
    messages: AtomicU64,
    bytes: AtomicU64,
}

impl Flow {
    /// One more message.
    pub fn add(&self, bytes: usize) {
        self.messages.fetch_add(1, Ordering::Relaxed);
        self.bytes.fetch_add(bytes as u64, Ordering::Relaxed);
    }

    fn report(&self) -> [u64; 2] {
        [self.messages.load(Ordering::Relaxed), self.bytes.load(Ordering::Relaxed)]
    }
}

impl Default for Metrics {
    fn default() -> Self {
        Self {
            started: Instant::now(),
            sent: Flow::default(),
            received: Flow::default(),
            num_sent_again: AtomicU64::new(0),
            num_overtaken: AtomicU64::new(0),
            num_rejected: AtomicU64::new(0),
            num_requests: AtomicU64::new(0),
            num_refused_requests: AtomicU64::new(0),
            num_lost_sessions: AtomicU64::new(0),
            round_trips: Histogram::default(),
        }
    }
}

/// Counts one more.
pub fn count(counter: &AtomicU64) {
    counter.fetch_add(1, Ordering::Relaxed);
}

impl Metrics {
    /// Time since the start.
    #[must_use]
    pub fn uptime(&self) -> Duration {
        self.started.elapsed()
    }

    /// The counts as JSON.
    #[must_use]
    pub fn report(&self) -> Value {
        let [num_sent, bytes_sent] = self.sent.report();
        let [num_received, bytes_received] = self.received.report();
        let load = |counter: &AtomicU64| counter.load(Ordering::Relaxed);
        json!({
            "uptime_s": self.uptime().as_secs_f64(),
            "num_sent": num_sent,
            "bytes_sent": bytes_sent,
            "num_received": num_received,
            "bytes_received": bytes_received,
            "num_sent_again": load(&self.num_sent_again),
            "num_overtaken": load(&self.num_overtaken),
            "num_rejected": load(&self.num_rejected),
            "num_requests": load(&self.num_requests),
            "num_refused_requests": load(&self.num_refused_requests),
            "num_lost_sessions": load(&self.num_lost_sessions),
            "round_trip": self.round_trips.report(),
        })
    }
}
