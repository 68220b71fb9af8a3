//! One session: its ports in the local domain, and its link to a daemon elsewhere.
//!
//! ```text
//! host -> StatePort -> thread of the session -> Outlet   ~network~>  daemon end
//! host <- DownPorts <- callback of the network           <~network~  daemon end
//! ```
//!
//! The newest state waits in shared memory until the window of the link is open. When the daemon is gone, the ports
//! towards the host are dropped, which a host takes for the end of a daemon: it registers again.

use std::{
    collections::VecDeque,
    sync::{
        Arc, Mutex, MutexGuard, OnceLock, PoisonError,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
    thread::Thread,
    time::{Duration, Instant},
};

use untangled_proto::CorrectionHeader;
use untangled_transport::throttle::Throttle;

use super::ports::{DeliverError, DownPorts, StatePort};
use crate::{
    metrics::{Metrics, count},
    net::{Outlet, Received},
    wire::message::{Envelope, Kind},
};

/// How long a host may take from the reply to the creation of its publisher.
const GRACE: Duration = Duration::from_secs(10);
/// Longest sleep of the session's thread.
const LONGEST_SLEEP: Duration = Duration::from_millis(250);
/// Frames that are remembered until they are answered.
const MAX_UNANSWERED: usize = 64;

/// The daemon of a session.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Remote {
    /// Name of the daemon end.
    pub(crate) daemon: Arc<str>,
    /// Runs of the daemon end and of its daemon.
    pub(crate) runs: [u64; 2],
    /// The session's number there.
    pub(crate) session: u64,
}

/// A host's cloth.
#[derive(Debug)]
pub(crate) struct Session {
    /// Its number in the local domain.
    pub(crate) id: u64,
    pub(crate) link: u64,
    pub(crate) remote: Remote,
    pub(crate) num_faces: u64,
    states: StatePort,
    down: Mutex<Option<DownPorts>>,
    received: Mutex<Received>,
    frames: Mutex<Frames>,
    outlet: Outlet,
    thread: OnceLock<Thread>,
    has_ended: AtomicBool,
    had_host: AtomicBool,
    created: Instant,
    metrics: Arc<Metrics>,
    num_frames: AtomicU64,
}

/// Frames that have left.
#[derive(Debug, Default)]
struct Frames {
    unanswered: VecDeque<u64>,
    newest: Option<u64>,
    /// Frame of the last repair that came.
    repaired: Option<u64>,
}

impl Frames {
    fn send(&mut self, frame: u64) {
        if self.unanswered.len() == MAX_UNANSWERED {
            self.unanswered.pop_front();
        }
        self.unanswered.push_back(frame);
        self.newest = Some(frame);
    }

    fn is_unanswered(&self, frame: u64) -> bool {
        self.unanswered.contains(&frame)
    }

    /// A repair may take minutes, and comes once.
    fn awaits_repair(&self, frame: u64) -> bool {
        self.newest.is_some_and(|newest| frame <= newest) && self.repaired.is_none_or(|last| last < frame)
    }

    /// A frame is answered, and those before it will not be.
    fn answer(&mut self, frame: u64) {
        if let Some(place) = self.unanswered.iter().position(|sent| *sent == frame) {
            self.unanswered.drain(..=place);
        }
    }
}

impl Session {
    pub(crate) fn new(
        [id, link, num_faces]: [u64; 3],
        remote: Remote,
        states: StatePort,
        down: DownPorts,
        outlet: Outlet,
        metrics: Arc<Metrics>,
    ) -> Self {
        Self {
            id,
            link,
            remote,
            num_faces,
            states,
            down: Mutex::new(Some(down)),
            received: Mutex::default(),
            frames: Mutex::default(),
            outlet,
            thread: OnceLock::new(),
            has_ended: AtomicBool::new(false),
            had_host: AtomicBool::new(false),
            created: Instant::now(),
            metrics,
            num_frames: AtomicU64::new(0),
        }
    }

    /// Starts the thread that sends states. It ends when the session does.
    pub(crate) fn start(self: &Arc<Self>) -> std::io::Result<()> {
        let session = Arc::clone(self);
        let thread = std::thread::Builder::new().name("states".into()).spawn(move || session.send_states())?;
        let _ = self.thread.set(thread.thread().clone());
        Ok(())
    }

    /// Frames that were answered.
    pub(crate) fn num_frames(&self) -> u64 {
        self.num_frames.load(Ordering::Relaxed)
    }

    /// Looks for a new state. For the thread that waits for events.
    pub(crate) fn wake(&self) {
        if !self.had_host.load(Ordering::Relaxed) && self.states.has_publisher() {
            self.had_host.store(true, Ordering::Relaxed);
        }
        if self.states.has_state() {
            self.unpark();
        }
    }

    /// Whether a host is there to send states, or may still come.
    pub(crate) fn has_host(&self) -> bool {
        let had_host = self.had_host.load(Ordering::Relaxed);
        if had_host { self.states.has_publisher() } else { self.created.elapsed() < GRACE }
    }

    /// Whether the daemon is gone, or the session was ended.
    pub(crate) fn has_ended(&self) -> bool {
        self.has_ended.load(Ordering::Relaxed)
    }

    /// Ends the session: the host finds its daemon gone.
    pub(crate) fn end(&self) {
        if !self.has_ended.swap(true, Ordering::Relaxed) {
            lock(&self.down).take();
            self.unpark();
        }
    }

    fn unpark(&self) {
        if let Some(thread) = self.thread.get() {
            thread.unpark();
        }
    }

    /// Sends states for as long as the session lives.
    fn send_states(&self) {
        let mut listens = false;
        while !self.has_ended() {
            if self.outlet.is_open() {
                // Before the state: the daemon must know of a listener before it works on the frame.
                let wants = lock(&self.down).as_ref().is_some_and(DownPorts::wants_paths);
                if wants != listens && self.states.has_state() {
                    self.outlet.tell(if wants { Kind::PathsOn } else { Kind::PathsOff });
                    listens = wants;
                }
                let taken = self.states.take(|length| self.outlet.begin(Kind::State, length));
                if let Some((frame, message)) = taken {
                    self.note_sent(frame);
                    self.outlet.send(Kind::State, message);
                    continue;
                }
                self.outlet.send_lost();
            }
            std::thread::park_timeout(LONGEST_SLEEP);
        }
    }

    fn note_sent(&self, frame: u64) {
        let mut frames = lock(&self.frames);
        let overtaken = frames.newest.map_or(0, |newest| frame.saturating_sub(newest).saturating_sub(1));
        self.metrics.num_overtaken.fetch_add(overtaken, Ordering::Relaxed);
        frames.send(frame);
    }

    /// A message of the daemon end has come. Never waits.
    pub(crate) fn receive(&self, envelope: Envelope, body: &[u8]) {
        match envelope.kind {
            Kind::Acknowledged => {
                self.outlet.acknowledge(envelope.sequence);
                self.unpark();
            }
            Kind::Gone => {
                count(&self.metrics.num_lost_sessions);
                self.end();
            }
            kind => self.deliver(kind, envelope.sequence, body),
        }
    }

    fn deliver(&self, kind: Kind, sequence: u64, body: &[u8]) {
        // Held to the end, so that messages reach the host in their order.
        let mut received = lock(&self.received);
        if received.take(sequence) && self.is_awaited(kind, body) {
            self.hand_on(kind, body);
        } else {
            self.reject(kind, &"it was not awaited");
        }
        // Whatever has become of it: what is not acknowledged is sent again.
        self.outlet.signal(Kind::Acknowledged, sequence);
    }

    fn hand_on(&self, kind: Kind, body: &[u8]) {
        let delivered = match lock(&self.down).as_mut() {
            Some(down) => down.deliver(kind, body),
            None => return,
        };
        match delivered {
            Ok(()) => {
                self.metrics.received.add(body.len());
                let Some(frame) = frame(body) else { return };
                match kind {
                    Kind::Dense | Kind::Sparse => {
                        lock(&self.frames).answer(frame);
                        self.num_frames.fetch_add(1, Ordering::Relaxed);
                    }
                    Kind::Repair => lock(&self.frames).repaired = Some(frame),
                    _ => {}
                }
            }
            Err(DeliverError::PinsMissing) => self.outlet.signal(Kind::PinsAgain, 0),
            Err(DeliverError::Malformed) => self.reject(kind, &"its lengths are wrong"),
            Err(DeliverError::Transport(reason)) => self.reject(kind, &reason),
        }
    }

    /// Whether a frame has left that a message may answer.
    fn is_awaited(&self, kind: Kind, body: &[u8]) -> bool {
        let Some(frame) = frame(body) else { return false };
        let frames = lock(&self.frames);
        match kind {
            Kind::Dense | Kind::Sparse => body.len() >= size_of::<CorrectionHeader>() && frames.is_unanswered(frame),
            Kind::Paths => frames.is_unanswered(frame),
            Kind::Repair => frames.awaits_repair(frame),
            _ => false,
        }
    }

    fn reject(&self, kind: Kind, reason: &dyn std::fmt::Display) {
        static REJECTED: Throttle = Throttle::new();
        count(&self.metrics.num_rejected);
        if let Some(num_suppressed) = REJECTED.admit() {
            tracing::warn!(session = self.id, ?kind, %reason, num_suppressed, "a message was dropped");
        }
    }
}

/// The frame of a message: all headers begin with it.
fn frame(body: &[u8]) -> Option<u64> {
    body.first_chunk().map(|bytes| u64::from_le_bytes(*bytes))
}

/// A panic while one of these locks is held leaves no inconsistent state that matters, so a poisoned lock is used on.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_answered_once_with_those_before_them_and_only_some_are_remembered() {
        let mut frames = Frames::default();
        for frame in 1..=100 {
            frames.send(frame);
        }
        assert!(!frames.is_unanswered(36) && frames.is_unanswered(37));
        frames.answer(50);
        assert!(!frames.is_unanswered(50) && !frames.is_unanswered(40) && frames.is_unanswered(51));
        frames.answer(7);
        assert_eq!(frames.unanswered.len(), 50);
        assert!(frames.awaits_repair(3) && !frames.awaits_repair(101));
        frames.repaired = Some(3);
        assert!(frames.awaits_repair(4) && !frames.awaits_repair(3), "a repair comes once");
    }
}
