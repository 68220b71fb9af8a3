//! Sends the messages of one direction of a session.

use std::{
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    time::Instant,
};

use zenoh::{Session, Wait, bytes::ZBytes, pubsub::Publisher};

use super::{
    Urgency,
    unacknowledged::{Message, Unacknowledged},
    window::Window,
};
use crate::{
    error::BridgeError,
    metrics::{Metrics, count},
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
    unacknowledged: Unacknowledged,
}

impl Flow {
    fn leave(&mut self, message: Message, now: Instant) {
        self.window.send(message.sequence, now);
        self.unacknowledged.keep(message, now);
    }

    /// A message that was lost, under a new number.
    fn take_lost(&mut self, now: Instant) -> Option<Message> {
        let lost = self.unacknowledged.take_lost(self.sequence + 1, now)?;
        self.sequence += 1;
        self.window.send(self.sequence, now);
        Some(lost)
    }
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
                // Acknowledgements may share a batch, of which there are few: with one each, many sessions lose theirs.
                .express(urgency == Urgency::Data)
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
    pub fn send(&self, kind: Kind, message: Vec<u8>) {
        let bytes = ZBytes::from(message);
        {
            let mut flow = self.flow();
            let sequence = flow.sequence;
            flow.leave(Message { kind, sequence, bytes: bytes.clone() }, Instant::now());
        }
        self.put(bytes);
    }

    /// Sends again what was lost with a connection and nothing newer has replaced. For the thread that sends frames,
    /// where it has no newer one.
    pub fn send_lost(&self) {
        while let Some(lost) = self.next_lost() {
            tracing::debug!(kind = ?lost.kind, sequence = lost.sequence, "sending a message again");
            count(&self.metrics.num_sent_again);
            self.put(lost.numbered(self.link));
        }
    }

    fn next_lost(&self) -> Option<Message> {
        self.flow().take_lost(Instant::now())
    }

    fn put(&self, bytes: ZBytes) {
        let length = bytes.len();
        if let Err(error) = self.data.put(bytes).wait() {
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
        let trip = {
            let mut flow = self.flow();
            flow.unacknowledged.acknowledge(sequence);
            flow.window.acknowledge(sequence, Instant::now())
        };
        if let Some(trip) = trip {
            self.metrics.round_trips.add(trip);
        }
    }
}

/// Which messages have come: each is taken once, and none after a later one.
#[derive(Debug, Default)]
pub struct Received {
    sequence: u64,
    frame: Option<[u8; 8]>,
}

impl Received {
    /// Whether a message is to be taken.
    pub fn take(&mut self, sequence: u64) -> bool {
        let is_new = sequence > self.sequence;
        self.sequence = self.sequence.max(sequence);
        is_new
    }

    /// Whether a state is the one before it, sent again since its acknowledgement was lost. Headers begin with the
    /// frame.
    pub fn repeats(&mut self, state: &[u8]) -> bool {
        let frame = state.first_chunk().copied();
        let is_repeated = frame.is_some() && frame == self.frame;
        self.frame = frame;
        is_repeated
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn received_takes_each_message_once_and_none_after_a_later_one_and_knows_a_repeated_state() {
        let mut received = Received::default();
        let taken: Vec<bool> = [1, 2, 2, 1, 5, 4, 6, 0].map(|sequence| received.take(sequence)).into();
        assert_eq!(taken, [true, true, false, false, true, false, true, false]);
        let repeated = [1_u64, 1, 2, 1].map(|frame| received.repeats(&[frame.to_le_bytes(), [0; 8]].concat()));
        assert_eq!(repeated, [false, true, false, false]);
        assert!(!received.repeats(&[]) && !received.repeats(&[]), "what has no frame is malformed");
    }
}
