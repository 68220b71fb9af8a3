//! The daemon: sessions, ingest, publish, housekeeping. The only user of iceoryx2 in this package.
//!
//! ```text
//! event ──> WaitSet ──> control ── register ──> session (mesh, settings, ports)
//!                   └─> session ── ingest ──> Untangler ──> publish ──> event to the host
//! tick  ──> housekeeping: dead nodes, sessions without a host
//! ```
//!
//! One thread serves all sessions; between events it sleeps. A session owns all that its frames need, so that a pool of
//! workers could own sessions instead. Whatever a peer wrote is copied before it is checked: it may write on.

mod clock;
mod control;
mod error;
mod ingest;
mod paths;
mod ports;
mod publish;
mod register;
mod session;
mod status;

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::Duration,
};

use iceoryx2::{
    port::listener::Listener,
    prelude::{
        CallbackProgression, Node, NodeBuilder, SignalHandlingMode, WaitSetAttachmentId, WaitSetBuilder,
        set_log_level_from_env_or,
    },
    waitset::WaitSetRunResult,
};
use untangled_proto::{
    Domain, limits,
    lock::{DomainLock, LockError},
    names,
    services::{self, Event, Ipc},
};

use crate::settings::Settings;

use control::ControlServer;
pub use error::ServeError;
use session::Session;

/// How often dead peers are looked for.
const HOUSEKEEPING: Duration = Duration::from_millis(500);

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
            settings: Settings::default(),
        }
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
    let mut lock = lock(&options.domain)?;
    lock.wipe_if_unused()?;
    options.domain.create_folders()?;
    lock.announce()?;
    let result = Daemon::start(options).and_then(|mut daemon| daemon.serve(shutdown, ready));
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

/// The daemon's state. Fields are dropped in order: ports before services before the node.
struct Daemon<'a> {
    sessions: Vec<Session>,
    control: ControlServer<'a>,
    listener: Listener<Ipc>,
    _event: Event,
    node: Node<Ipc>,
}

impl<'a> Daemon<'a> {
    fn start(options: &'a ServeOptions) -> Result<Self, ServeError> {
        let node = NodeBuilder::new()
            .config(&options.domain.config()?)
            .signal_handling_mode(SignalHandlingMode::HandleTerminationRequests)
            .create::<Ipc>()
            .map_err(|error| ServeError::transport("creating a node", &error))?;
        // A daemon that was killed still counts as a server until its node is cleaned up.
        let _ = node.try_cleanup_dead_nodes();
        let event = services::create_shared_event(&node, names::CONTROL)
            .map_err(|error| ServeError::transport("creating the control event", &error))?;
        let listener =
            event.listener_builder().create().map_err(|error| ServeError::transport("creating a listener", &error))?;
        // The server comes last: clients that see it find everything else in place.
        let control = ControlServer::start(&node, options)?;
        Ok(Self { sessions: Vec::new(), control, listener, _event: event, node })
    }

    fn serve(&mut self, shutdown: &Shutdown, ready: impl FnOnce()) -> Result<(), ServeError> {
        let Self { sessions, control, listener, node, .. } = self;
        let failed = |error: &dyn std::fmt::Debug| ServeError::Transport {
            what: "waiting for events",
            reason: format!("{error:?}"),
        };
        let waitset = WaitSetBuilder::new()
            .signal_handling_mode(SignalHandlingMode::HandleTerminationRequests)
            .create::<Ipc>()
            .map_err(|error| failed(&error))?;
        let _wake = waitset.attach_notification(&*listener).map_err(|error| failed(&error))?;
        let tick = waitset.attach_interval(HOUSEKEEPING).map_err(|error| failed(&error))?;
        let mut on_event = |event: WaitSetAttachmentId<Ipc>| {
            if event.has_event_from(&tick) {
                // What it counts is not news: some dead nodes can never be removed.
                let _ = node.try_cleanup_dead_nodes();
            } else if let Err(error) = listener.try_wait(|_| {}) {
                tracing::warn!(?error, "draining events");
            }
            // Events are drained first: whatever comes from here on wakes again.
            control.answer(node, sessions);
            for session in &mut *sessions {
                session.serve();
            }
            sessions.retain(Session::has_host);
            if shutdown.is_requested() { CallbackProgression::Stop } else { CallbackProgression::Continue }
        };
        // The first wait installs the handlers of signals; only then may somebody count on them.
        let mut result = waitset.wait_and_process_once_with_timeout(&mut on_event, Duration::ZERO);
        ready();
        loop {
            match result.map_err(|error| failed(&error))? {
                WaitSetRunResult::TerminationRequest | WaitSetRunResult::StopRequest => return Ok(()),
                // Any signal interrupts; one that asks to end is reported by the next wait.
                WaitSetRunResult::Interrupt | WaitSetRunResult::AllEventsHandled => {}
            }
            result = waitset.wait_and_process_once(&mut on_event);
        }
    }
}
