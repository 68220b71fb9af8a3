//! The daemon end of one session: a client's ports, and the way to the host end.

use std::{
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    time::{Duration, Instant},
};

use iceoryx2::port::listener::Listener;
use untangled_client::RequestError;
use untangled_proto::names;
use untangled_transport::{services::Ipc, throttle::Throttle};

use super::{
    local::Local,
    ports::{self, CorrectionPort, PathsPort, RepairPort, Shape, StateError, StatePort},
};
use crate::{
    metrics::{Metrics, count},
    net::{Outlet, Received},
    wire::{
        elements::Pins,
        message::{Envelope, Kind},
        request::Services,
    },
};

/// Waits for an event, which may be lost: the first one, the longest one while frames are in work, and while none are,
/// and the one while the network is full.
const FIRST_WAIT: Duration = Duration::from_millis(1);
const WAIT_GROWTH: u32 = 4;
const LONGEST_WAIT: Duration = Duration::from_millis(50);
const IDLE_WAIT: Duration = Duration::from_millis(250);
const FULL_WAIT: Duration = Duration::from_millis(1);

/// The daemon end of one session. The thread of the link sends what the daemon answers; what the host sends is handed
/// on by the callback of the network.
#[derive(Debug)]
pub(super) struct Link {
    host: Arc<str>,
    shape: Shape,
    states: StatePort,
    received: Mutex<Received>,
    /// Open while somebody listens at the other end.
    paths: Mutex<Option<PathsPort>>,
    outlet: Outlet,
    has_ended: AtomicBool,
    wants_pins: AtomicBool,
    is_busy: AtomicBool,
    pub(super) opened: Instant,
    metrics: Arc<Metrics>,
    local: Arc<Local>,
}

/// What the thread of a link has to itself. Fields are dropped in order: ports before services.
#[derive(Debug)]
pub(super) struct Answers {
    corrections: CorrectionPort,
    repairs: Option<RepairPort>,
    listener: Listener<Ipc>,
    pins: Pins,
    body: Vec<u8>,
    /// A correction whose paths have to leave before it.
    waiting: Option<(Kind, Vec<u8>)>,
}

impl Answers {
    pub(super) fn open(local: &Local, shape: &Shape) -> Result<Self, RequestError> {
        let node = local.connection().node();
        Ok(Self {
            corrections: CorrectionPort::open(node, shape)?,
            repairs: RepairPort::open(node, shape)?,
            listener: ports::listener(node, shape)?,
            pins: Pins::default(),
            body: Vec::new(),
            waiting: None,
        })
    }

    pub(super) fn services(&self) -> Services {
        Services::default()
            .with(Services::SPARSE, self.corrections.is_sparse())
            .with(Services::REPAIRS, self.repairs.is_some())
    }
}

impl Link {
    pub(super) fn open(
        host: Arc<str>,
        shape: Shape,
        outlet: Outlet,
        metrics: Arc<Metrics>,
        local: Arc<Local>,
    ) -> Result<Self, RequestError> {
        Ok(Self {
            host,
            shape,
            states: StatePort::open(local.connection(), &shape)?,
            received: Mutex::default(),
            paths: Mutex::default(),
            outlet,
            has_ended: AtomicBool::new(false),
            wants_pins: AtomicBool::new(false),
            is_busy: AtomicBool::new(false),
            opened: Instant::now(),
            metrics,
            local,
        })
    }

    /// Starts the thread that sends answers. It ends when the link does.
    pub(super) fn start(self: &Arc<Self>, answers: Answers) -> std::io::Result<()> {
        let link = Arc::clone(self);
        std::thread::Builder::new().name("answers".into()).spawn(move || link.send_answers(answers))?;
        Ok(())
    }

    /// The session's number at the daemon.
    pub(super) fn session(&self) -> u64 {
        self.shape.session
    }

    pub(super) fn has_ended(&self) -> bool {
        self.has_ended.load(Ordering::Relaxed)
    }

    /// Ends the link; the daemon sees that its host is gone as soon as the last port is dropped.
    pub(super) fn end(&self) {
        self.has_ended.store(true, Ordering::Relaxed);
    }

    /// A message of the host end has come. Never waits.
    pub(super) fn receive(&self, envelope: Envelope, body: &[u8]) {
        match envelope.kind {
            Kind::Acknowledged => self.outlet.acknowledge(envelope.sequence),
            Kind::PinsAgain => self.wants_pins.store(true, Ordering::Relaxed),
            kind => self.take(kind, envelope.sequence, body),
        }
    }

    fn take(&self, kind: Kind, sequence: u64, body: &[u8]) {
        // Held to the end, so that messages reach the daemon in their order.
        let mut received = lock(&self.received);
        if !received.take(sequence) {
            return self.reject(kind, &"it came twice, or late");
        }
        match kind {
            // The first of them came, and its acknowledgement did not.
            Kind::State if received.repeats(body) => self.reject(kind, &"it came twice"),
            Kind::State => self.hand_on(body),
            Kind::PathsOn => match PathsPort::open(self.local.connection().node(), &self.shape) {
                Ok(port) => *lock(&self.paths) = Some(port),
                Err(error) => self.reject(kind, &error),
            },
            Kind::PathsOff => *lock(&self.paths) = None,
            _ => self.reject(kind, &"it goes the other way"),
        }
        if kind == Kind::State {
            self.outlet.signal(Kind::Acknowledged, sequence);
        }
    }

    fn hand_on(&self, state: &[u8]) {
        match self.states.send(state) {
            Ok(()) => {
                self.is_busy.store(true, Ordering::Relaxed);
                self.local.connection().wake(names::EVENT_STATE);
                self.metrics.received.add(state.len());
            }
            Err(StateError::Malformed) => self.reject(Kind::State, &"its lengths are wrong"),
            Err(StateError::Transport(reason)) => self.reject(Kind::State, &reason),
        }
    }

    fn reject(&self, kind: Kind, reason: &dyn std::fmt::Display) {
        static REJECTED: Throttle = Throttle::new();
        count(&self.metrics.num_rejected);
        if let Some(num_suppressed) = REJECTED.admit() {
            let host = &*self.host;
            tracing::warn!(host, session = self.session(), ?kind, %reason, num_suppressed, "a message was dropped");
        }
    }

    /// Sends answers for as long as the link lives.
    fn send_answers(&self, mut answers: Answers) {
        let mut wait = FIRST_WAIT;
        while !self.has_ended() {
            let mut has_sent = false;
            while self.outlet.is_open() && self.send_next(&mut answers) {
                has_sent = true;
            }
            if self.outlet.is_open() {
                self.outlet.send_lost();
            }
            if has_sent {
                wait = FIRST_WAIT;
            } else if !answers.corrections.has_publisher()
                || (wait >= LONGEST_WAIT && answers.corrections.has_dead_user())
            {
                count(&self.metrics.num_lost_sessions);
                self.outlet.signal(Kind::Gone, 0);
                self.end();
                break;
            }
            let is_busy = self.is_busy.load(Ordering::Relaxed);
            let longest = if is_busy { LONGEST_WAIT } else { IDLE_WAIT };
            let slice = if self.outlet.is_open() { wait.min(longest) } else { FULL_WAIT };
            // An interrupted wait is a shorter one.
            let is_woken = answers.listener.timed_wait(|_| {}, slice).is_ok_and(|num_events| num_events > 0);
            wait = if is_woken { FIRST_WAIT } else { (WAIT_GROWTH * wait).min(longest) };
        }
        drop(answers);
        // The daemon checks its sessions whenever it is woken.
        self.local.connection().wake(names::EVENT_STATE);
    }

    /// Sends the next message, if there is one.
    fn send_next(&self, answers: &mut Answers) -> bool {
        if let Some((kind, body)) = answers.waiting.take() {
            self.send(kind, &body);
            return true;
        }
        if self.wants_pins.swap(false, Ordering::Relaxed) {
            answers.pins.forget();
        }
        if let Some((kind, frame)) = answers.corrections.take(&mut answers.pins, &mut answers.body) {
            self.is_busy.store(false, Ordering::Relaxed);
            let paths = lock(&self.paths).as_mut().and_then(|port| port.take(frame));
            if let Some(paths) = paths {
                answers.waiting = Some((kind, std::mem::take(&mut answers.body)));
                self.send(Kind::Paths, &paths);
            } else {
                self.send(kind, &answers.body);
            }
            return true;
        }
        if answers.repairs.as_ref().is_some_and(|port| port.take(&mut answers.body)) {
            self.send(Kind::Repair, &answers.body);
            return true;
        }
        false
    }

    fn send(&self, kind: Kind, body: &[u8]) {
        let mut message = self.outlet.begin(kind, body.len());
        message.extend_from_slice(body);
        self.outlet.send(kind, message);
    }
}

/// A panic while one of these locks is held leaves no inconsistent state that matters, so a poisoned lock is used on.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
