//! The daemon: sessions, ingest, publish, housekeeping. The only user of iceoryx2 in this package.
//!
//! ```text
//! event ──> listener ─> control ───────> pool: register ──> session (mesh, settings, ports)
//!                   └─> sessions ──────> pool: ingest ──> Untangler ──> publish ──> event to the host
//! tick  ──> housekeeping: dead nodes, sessions without a host
//! ```
//!
//! One thread waits for events and hands out work; workers do it, each session's by one worker at a time. Between events all of them
//! sleep. Whatever a peer wrote is copied before it is checked: it may write on.

mod clock;
mod control;
mod descriptors;
mod error;
#[doc(hidden)]
pub mod fuzz;
mod ingest;
mod janitor;
mod leftovers;
mod metrics;
mod paths;
mod pool;
mod ports;
mod publish;
mod quiet;
mod register;
mod registry;
mod session;
mod status;
mod throttle;

use std::{
    net::SocketAddr,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::{Duration, Instant},
};

use iceoryx2::{
    node::NodeWaitFailure,
    port::listener::{Listener, ListenerWaitError},
    prelude::{Node, NodeBuilder, SignalHandlingMode, set_log_level_from_env_or},
};
use untangled_transport::{Domain, lock::{DomainLock, LockError}, memory, services::{self, Event, Ipc}};
use untangled_proto::{limits, names};

use untangle::settings::Settings;

use control::{ControlServer, RegistrationJob};
pub use error::ServeError;
use janitor::Janitor;
use metrics::MetricsServer;
use pool::{Job, Pool};
use quiet::Quiet;
use registry::Registry;
use session::Session;
use throttle::Throttle;

/// How often dead peers are looked for.
const HOUSEKEEPING: Duration = Duration::from_millis(500);
/// How long after an event the daemon looks by itself, and by how much the next looks are further apart: a notifier of iceoryx2 0.10 that
/// is interrupted while the daemon drains its events leaves the listener marked as notified with nothing to wake it; no later
/// notification wakes it either until it is drained again.
const FIRST_LOOK: Duration = Duration::from_millis(1);
const LOOK_GROWTH: u32 = 4;

/// What a daemon serves, and how much of it.
#[derive(Clone, Debug)]
pub struct ServeOptions {
    /// Where clients find it.
    pub domain: Domain,
    /// Most sessions at a time, at most [`limits::MAX_SESSIONS`].
    pub max_sessions: usize,
    /// Most vertices of a session.
    pub max_vertices: usize,
    /// Most faces of a session.
    pub max_faces: usize,
    /// Threads that work on frames, at least 2; 0 for as many as there are processors.
    pub num_workers: usize,
    /// Where to serve metrics as Prometheus text over HTTP, if anywhere. Whoever can connect can read them: loopback only.
    pub metrics: Option<SocketAddr>,
    /// Settings of sessions, where a session does not choose its own.
    pub settings: Settings,
}

impl ServeOptions {
    /// A domain with default limits and settings.
    #[must_use]
    pub fn new(domain: Domain) -> Self {
        Self {
            domain,
            max_sessions: limits::MAX_SESSIONS,
            max_vertices: limits::MAX_VERTICES,
            max_faces: limits::MAX_FACES,
            num_workers: 0,
            metrics: None,
            settings: Settings::default(),
        }
    }

    fn num_workers(&self) -> usize {
        let chosen = match self.num_workers {
            0 => std::thread::available_parallelism().map_or(2, usize::from),
            chosen => chosen,
        };
        chosen.max(2)
    }
}

/// Asks a running daemon to end, from any thread: it does so after the frame in work, within half a second when idle.
#[derive(Clone, Debug, Default)]
pub struct Shutdown(Arc<AtomicBool>);

impl Shutdown {
    /// Asks.
    pub fn request(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    fn is_requested(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// Serves a domain until SIGINT, SIGTERM or `shutdown`. `ready` is called once, when clients can connect.
///
/// Nothing stays in shared memory, unless clients are still there: what they hold goes with them.
///
/// # Errors
/// [`ServeError`], in particular when another daemon serves the domain.
pub fn run(options: &ServeOptions, shutdown: &Shutdown, ready: impl FnOnce()) -> Result<(), ServeError> {
    // What iceoryx2 reports is handled here and logged once; whoever wants its own words sets IOX2_LOG_LEVEL.
    set_log_level_from_env_or(iceoryx2::prelude::LogLevel::Fatal);
    let options = &ServeOptions { max_sessions: descriptors::make_room(options.max_sessions), ..options.clone() };
    let mut lock = lock(&options.domain)?;
    lock.wipe_if_unused()?;
    options.domain.create_folders()?;
    lock.announce()?;
    let result = Daemon::start(options).and_then(|daemon| daemon.serve(shutdown, ready));
    // All ports, services and the node are gone by now.
    lock.withdraw()?;
    lock.wipe_if_unused()?;
    result
}

/// Takes the domain's lock. A client that is just leaving may have it for a moment.
fn lock(domain: &Domain) -> Result<DomainLock<'_>, LockError> {
    const ATTEMPTS: u32 = 10;
    for _ in 1..ATTEMPTS {
        match DomainLock::acquire(domain) {
            Err(LockError::Held { .. }) => std::thread::sleep(Duration::from_millis(20)),
            other => return other,
        }
    }
    DomainLock::acquire(domain)
}

/// What a worker does.
#[derive(Debug)]
enum Task {
    Frame(Arc<Session>),
    Register(Box<RegistrationJob>),
}

impl Job for Task {
    fn is_large(&self) -> bool {
        match self {
            Self::Frame(session) => session.is_large(),
            Self::Register(job) => job.is_large(),
        }
    }

    fn run(self) -> Option<Self> {
        match self {
            Self::Frame(session) => session.serve().then_some(Self::Frame(session)),
            Self::Register(job) => {
                job.run();
                None
            }
        }
    }
}

/// The daemon's state. Fields are dropped in order: threads before ports before services before the node.
struct Daemon {
    pool: Pool<Task>,
    _metrics: Option<MetricsServer>,
    control: ControlServer,
    registry: Arc<Registry>,
    listener: Listener<Ipc>,
    _event: Event,
    node: Arc<Node<Ipc>>,
    _janitor: Janitor,
}

impl Daemon {
    fn start(options: &ServeOptions) -> Result<Self, ServeError> {
        let janitor = Janitor::start(options.domain.clone())?;
        let node = NodeBuilder::new()
            .config(&options.domain.config()?)
            .signal_handling_mode(SignalHandlingMode::HandleTerminationRequests)
            .create::<Ipc>()
            .map_err(|error| ServeError::transport("creating a node", &error))?;
        let node = Arc::new(node);
        memory::close_to_others(&options.domain)
            .map_err(|source| ServeError::System { what: "closing shared memory to other users", source })?;
        // A daemon that was killed still counts as a server until its node is cleaned up.
        let _ = node.try_cleanup_dead_nodes();
        let event = services::create_shared_event(&node, names::CONTROL)
            .map_err(|error| ServeError::transport("creating the control event", &error))?;
        let listener =
            event.listener_builder().create().map_err(|error| ServeError::transport("creating a listener", &error))?;
        let registry = Arc::new(Registry::new(Arc::clone(&node), options.clone()));
        let pool = Pool::start(options.num_workers())
            .map_err(|source| ServeError::System { what: "starting a worker", source })?;
        let metrics = options.metrics.map(|address| MetricsServer::start(address, Arc::clone(&registry)));
        let metrics = metrics.transpose()?;
        // The server comes last: clients that see it find everything else in place.
        let control = ControlServer::start(&node, Arc::clone(&registry))?;
        Ok(Self { pool, _metrics: metrics, control, registry, listener, _event: event, node, _janitor: janitor })
    }

    fn serve(self, shutdown: &Shutdown, ready: impl FnOnce()) -> Result<(), ServeError> {
        // The first look at signals installs their handlers; only then may somebody count on them.
        if self.is_asked_to_end() {
            return Ok(());
        }
        ready();
        let (mut kept, mut quiet) = (Instant::now(), Quiet::new(&self.registry.options().domain));
        let mut pause = FIRST_LOOK;
        loop {
            let woken = match self.listener.timed_wait(|_| {}, pause) {
                Ok(num_events) => num_events > 0,
                Err(ListenerWaitError::InterruptSignal) => false,
                Err(error) => {
                    static FAILED: Throttle = Throttle::new();
                    if let Some(num_suppressed) = FAILED.admit() {
                        tracing::warn!(?error, num_suppressed, "waiting for events");
                    }
                    std::thread::sleep(pause);
                    false
                }
            };
            let is_time = kept.elapsed() >= HOUSEKEEPING;
            if shutdown.is_requested() || ((is_time || !woken) && self.is_asked_to_end()) {
                return Ok(());
            }
            pause = if woken { FIRST_LOOK } else { (LOOK_GROWTH * pause).clamp(FIRST_LOOK, HOUSEKEEPING) };
            if is_time {
                if !quiet.is_quiet() {
                    // What it counts is not news: some dead nodes can never be removed.
                    let _ = self.node.try_cleanup_dead_nodes();
                }
                kept = Instant::now();
            }
            // Events are drained first: whatever comes from here on wakes again.
            self.control.answer(|job| self.pool.push(Task::Register(Box::new(job))));
            self.registry.sessions().retain(|session| {
                if session.wake() {
                    self.pool.push(Task::Frame(Arc::clone(session)));
                }
                session.has_host()
            });
        }
    }

    /// Whether a signal has come that asks to end. Costs a system call.
    fn is_asked_to_end(&self) -> bool {
        self.node.wait(Duration::ZERO) == Err(NodeWaitFailure::TerminationRequest)
    }
}
