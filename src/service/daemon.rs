//! The run loop of a daemon: starts everything, waits for events, hands out work, ends in order.

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::Duration,
};

use iceoryx2::{
    node::NodeWaitFailure,
    port::listener::{Listener, ListenerWaitError},
    prelude::{LogLevel, Node, SignalHandlingMode, set_log_level_from_env_or},
};
use untangled_proto::names;
use untangled_transport::{
    Domain,
    housekeeping::{Cleanup, DeadNodes, Finding},
    lock::DomainLock,
    memory, node,
    services::{self, Event, Ipc},
    throttle::Throttle,
};

use super::{
    descriptors::{DescriptorRoom, make_room_for_descriptors},
    error::ServeError,
    metrics::MetricsServer,
    options::ServeOptions,
    pool::{Alone, Job, Pool, PoolOptions},
    requests::{ControlServer, MeshRequest, Registry},
    session::Session,
};

/// Longest wait for an event.
const LONGEST_WAIT: Duration = DeadNodes::INTERVAL;
/// How soon after an event the daemon wakes without one, and by what factor each further wait is longer. A notifier of
/// iceoryx2 0.10 that is interrupted while the daemon drains its events leaves the listener marked as notified with
/// nothing to wake it; later notifications do not wake it either, until it is drained again.
const FIRST_WAIT: Duration = Duration::from_millis(1);
const WAIT_GROWTH: u32 = 4;

/// Asks a running daemon to end, from any thread: it ends after the frame in work, within half a second when idle.
#[derive(Clone, Debug, Default)]
pub struct Shutdown(Arc<AtomicBool>);

impl Shutdown {
    /// Asks.
    pub fn request(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// What [`request`](Self::request) sets: for handlers of signals, which may do no more.
    #[must_use]
    pub fn flag(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.0)
    }

    fn is_requested(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// Serves a domain until SIGINT, SIGTERM or `shutdown`. `ready` is called once, when clients can connect.
///
/// Nothing stays in shared memory, unless clients are still there: what they hold is removed when they end.
///
/// # Errors
/// [`ServeError`], in particular when another daemon serves the domain.
pub fn run(options: &ServeOptions, shutdown: &Shutdown, ready: impl FnOnce() + Send) -> Result<(), ServeError> {
    // What iceoryx2 reports is handled here and logged once; its own log is switched on by IOX2_LOG_LEVEL.
    set_log_level_from_env_or(LogLevel::Fatal);
    let room = make_room_for_descriptors(options.max_sessions);
    let options = &ServeOptions { max_sessions: room.max_sessions, ..options.clone() };
    let mut lock = DomainLock::acquire_patiently(&options.domain)?;
    lock.wipe_if_unused()?;
    options.domain.create_folders()?;
    lock.announce()?;
    let result = Daemon::start(options, room).and_then(|daemon| daemon.serve_on_own_thread(shutdown, ready));
    // All ports, services and the node are gone by now.
    lock.withdraw()?;
    lock.wipe_if_unused()?;
    lock.remove()?;
    result
}

/// What a worker does.
#[derive(Debug)]
enum Task {
    Frame(Arc<Session>),
    Request(Box<MeshRequest>),
    LateView(Arc<Session>),
}

impl Job for Task {
    fn is_large(&self) -> bool {
        match self {
            Self::Frame(session) => session.is_large(),
            Self::Request(job) => job.is_large(),
            Self::LateView(_) => false,
        }
    }

    fn run(self) -> Option<Self> {
        match self {
            Self::Frame(session) => session.serve().then_some(Self::Frame(session)),
            Self::Request(job) => {
                job.run();
                None
            }
            Self::LateView(session) => {
                session.publish_late_view();
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
    _cleanup: Cleanup,
}

impl Daemon {
    fn start(options: &ServeOptions, room: DescriptorRoom) -> Result<Self, ServeError> {
        let cleanup = Cleanup::start(options.domain.clone(), options.domain.config()?, log_finding)
            .map_err(|source| ServeError::System { what: "starting the cleanup thread".to_owned(), source })?;
        let node = create_node(&options.domain)?;
        memory::close_to_others(&options.domain)
            .map_err(|source| ServeError::System { what: "closing shared memory to other users".to_owned(), source })?;
        // A daemon that was killed still counts as a server until its node is cleaned up.
        node::clean_up_dead(&node);
        let event = services::create_shared_event(&node, names::CONTROL)
            .map_err(|error| ServeError::transport("creating the control event", &error))?;
        let listener =
            event.listener_builder().create().map_err(|error| ServeError::transport("creating a listener", &error))?;
        let registry = Arc::new(Registry::new(Arc::clone(&node), options.clone(), room));
        let pool = Pool::start(PoolOptions::frames(options.num_workers()))
            .map_err(|source| ServeError::System { what: "starting a worker".to_owned(), source })?;
        let metrics = options.metrics.map(|address| MetricsServer::start(address, Arc::clone(&registry)));
        let metrics = metrics.transpose()?;
        // The server comes last: clients that see it find everything else in place.
        let control = ControlServer::start(&node, Arc::clone(&registry))?;
        Ok(Self { pool, _metrics: metrics, control, registry, listener, _event: event, node, _cleanup: cleanup })
    }

    /// Serves on a thread that is the daemon's own, since it does brief frames itself, and they must stay there.
    fn serve_on_own_thread(self, shutdown: &Shutdown, ready: impl FnOnce() + Send) -> Result<(), ServeError> {
        let own = std::thread::Builder::new().name("server".to_owned());
        std::thread::scope(|scope| {
            let serving = own.spawn_scoped(scope, || {
                let _alone = Alone::begin();
                self.serve(shutdown, ready)
            });
            let serving = serving
                .map_err(|source| ServeError::System { what: "starting the serving thread".to_owned(), source })?;
            serving.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
        })
    }

    fn serve(self, shutdown: &Shutdown, ready: impl FnOnce()) -> Result<(), ServeError> {
        // The first check for signals installs their handlers; only then may a caller count on them.
        if self.is_asked_to_end() {
            return Ok(());
        }
        ready();
        let mut dead_nodes = DeadNodes::new(&self.registry.options().domain);
        let mut wait = FIRST_WAIT;
        loop {
            let is_woken = self.wait_for_event(wait);
            let is_time = dead_nodes.is_due();
            if shutdown.is_requested() || ((is_time || !is_woken) && self.is_asked_to_end()) {
                return Ok(());
            }
            wait = if is_woken { FIRST_WAIT } else { (WAIT_GROWTH * wait).clamp(FIRST_WAIT, LONGEST_WAIT) };
            if is_time {
                dead_nodes.clean_up(&self.node);
                self.registry.end_abandoned();
            }
            wait = wait.min(self.hand_out_work());
        }
    }

    /// Sleeps until an event comes, at most for `wait`; whether one came.
    fn wait_for_event(&self, wait: Duration) -> bool {
        match self.listener.timed_wait(|_| {}, wait) {
            Ok(num_events) => num_events > 0,
            Err(ListenerWaitError::InterruptSignal) => false,
            Err(error) => {
                static FAILED: Throttle = Throttle::new();
                if let Some(num_suppressed) = FAILED.admit() {
                    tracing::warn!(?error, num_suppressed, "waiting for events");
                }
                std::thread::sleep(wait);
                false
            }
        }
    }

    /// Answers requests, queues sessions that have a new state, drops sessions without a host. The events that announce
    /// them have been drained before, so that everything that comes from here on wakes the daemon again.
    ///
    /// Gives back the longest wait until there is something to do without an event.
    fn hand_out_work(&self) -> Duration {
        let mut longest = LONGEST_WAIT;
        self.control.answer(|job| self.pool.push(Task::Request(Box::new(job))));
        let mut own = None;
        let mut sessions = self.registry.sessions();
        let has_others = sessions.len() > 1;
        sessions.retain(|session| {
            if session.wake() {
                let task = Task::Frame(Arc::clone(session));
                if own.is_none() && session.is_brief(has_others) { own = Some(task) } else { self.pool.push(task) }
            }
            match session.take_late_view() {
                Some(Duration::ZERO) => self.pool.push(Task::LateView(Arc::clone(session))),
                Some(left) => longest = longest.min(left.max(FIRST_WAIT)),
                None => {}
            }
            session.has_host()
        });
        drop(sessions);
        // Waking a worker would take longer. Others that have a state have their workers by now.
        if let Some(again) = own.and_then(Task::run) {
            self.pool.push(again);
        }
        longest
    }

    /// Whether a signal has come that asks to end. Costs a system call.
    fn is_asked_to_end(&self) -> bool {
        self.node.wait(Duration::ZERO) == Err(NodeWaitFailure::TerminationRequest)
    }
}

fn create_node(domain: &Domain) -> Result<Arc<Node<Ipc>>, ServeError> {
    let node = node::create(&domain.config()?, SignalHandlingMode::HandleTerminationRequests)
        .map_err(|error| ServeError::transport("creating a node", &error))?;
    Ok(Arc::new(node))
}

fn log_finding(finding: Finding) {
    match finding {
        Finding::Unfinished(removed) => tracing::info!(removed, "segments that killed peers left unfinished"),
        Finding::Left(removed) => tracing::info!(removed, "files that killed peers left"),
        Finding::Failed(error) => tracing::warn!(%error, "looking for what killed peers left"),
    }
}
