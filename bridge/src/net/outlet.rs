//! Sends the messages of one direction of a session.

use std::{
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    time::Instant,
};

use zenoh::{Session, Wait, pubsub::Publisher};

use super::{Urgency, window::Window};
use crate::{
    error::BridgeError,
    metrics::Metrics,
    wire::message::{Envelope, Kind},
};

/// Sends the messages of one direction of a session. Frames are sent by one thread; any thread sends signals.
#[derive(Debug)]
pub struct Outlet {
    data: Publisher<'static>,
    signals: Publisher<'static>,
    link: u64,
    flow: Mutex<Flow>,
    metrics: Arc<Metrics>,
}

#[derive(Debug, Default)]
struct Flow {
    sequence: u64,
    window: Window,
}

impl Outlet {
    /// Declares the publishers of a key.
    ///
    /// # Errors
    /// [`BridgeError::Network`].
    pub fn new(session: &Session, key: &str, link: u64, metrics: Arc<Metrics>) -> Result<Self, BridgeError> {
        let declare = |urgency: Urgency| {
            session
                .declare_publisher(key.to_owned())
                .priority(urgency.priority())
                .congestion_control(urgency.congestion())
                .express(true)
                .wait()
                .map_err(|error| BridgeError::network("declaring a publisher", &error))
        };
        let (data, signals) = (declare(Urgency::Data)?, declare(Urgency::Signal)?);
        Ok(Self { data, signals, link, flow: Mutex::default(), metrics })
    }

    fn flow(&self) -> MutexGuard<'_, Flow> {
        // A panic while it is held leaves no inconsistent state.
        self.flow.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Whether a frame may leave now.
    #[must_use]
    pub fn is_open(&self) -> bool {
        self.flow().window.is_open(Instant::now())
    }

    /// Whether frames are on their way.
    #[must_use]
    pub fn is_waiting(&self) -> bool {
        self.flow().window.is_waiting()
    }

    /// Begins a message with room for `length` bytes behind the envelope.
    #[must_use]
    pub fn begin(&self, kind: Kind, length: usize) -> Vec<u8> {
        let mut flow = self.flow();
        flow.sequence += 1;
        Envelope { kind, link: self.link, sequence: flow.sequence }.begin(length)
    }

    /// Sends a frame that was begun last; waits where the connection has no room for it.
    pub fn send(&self, message: Vec<u8>) {
        let length = message.len();
        {
            let mut flow = self.flow();
            let sequence = flow.sequence;
            flow.window.send(sequence, Instant::now());
        }
        if let Err(error) = self.data.put(message).wait() {
            // The session of the network is closed, which ends this process.
            tracing::debug!(%error, "sending a frame");
        }
        self.metrics.sent.add(length);
    }

    /// Sends a message without a payload in the order of frames, for which no acknowledgement is awaited.
    pub fn tell(&self, kind: Kind) {
        let message = self.begin(kind, 0);
        if let Err(error) = self.data.put(message).wait() {
            tracing::debug!(%error, "sending a message");
        }
    }

    /// Sends a message without a payload that overtakes frames. Never waits.
    pub fn signal(&self, kind: Kind, sequence: u64) {
        let message = Envelope { kind, link: self.link, sequence }.begin(0);
        if let Err(error) = self.signals.put(message).wait() {
            tracing::debug!(%error, "sending a signal");
        }
    }

    /// The other end has all messages up to this one.
    pub fn acknowledge(&self, sequence: u64) {
        let trip = self.flow().window.acknowledge(sequence, Instant::now());
        if let Some(trip) = trip {
            self.metrics.round_trips.add(trip);
        }
    }
}

/// Which messages have come: each is taken once, and none after a later one.
#[derive(Debug, Default)]
pub struct Received(u64);

impl Received {
    /// Whether a message is to be taken.
    pub fn take(&mut self, sequence: u64) -> bool {
        let is_new = sequence > self.0;
        self.0 = self.0.max(sequence);
        is_new
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn received_takes_each_message_once_and_none_after_a_later_one() {
        let mut received = Received::default();
        let taken: Vec<bool> = [1, 2, 2, 1, 5, 4, 6, 0].map(|sequence| received.take(sequence)).into();
        assert_eq!(taken, [true, true, false, false, true, false, true, false]);
    }
}
