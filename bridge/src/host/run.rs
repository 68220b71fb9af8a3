//! The run loop of a host end: starts everything, waits for events, hands out requests, ends in order.

use std::{
    collections::hash_map::RandomState,
    hash::BuildHasher,
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering},
    },
    time::{Duration, Instant},
};

use iceoryx2::prelude::{LogLevel, SignalHandlingMode, set_log_level_from_env_or};
use untangled_proto::names;
use untangled_transport::{housekeeping::DeadNodes, lock::DomainLock, memory, node as nodes, services};
use zenoh::Wait;

use super::{
    directory::Directory,
    front::{Doorbell, Inlet},
    listen::subscribe,
    requests,
    sessions::Sessions,
    shared::Shared,
    status,
};
use crate::{
    error::BridgeError,
    housekeeping::Housekeeping,
    metrics::{Server, count},
    net::{self, Urgency},
    options::Options,
    wire::{
        beacon::{self, HostBeacon, Versions},
        keys,
    },
};

/// How soon after an event this end wakes without one, and by what factor each further wait is longer: an event of
/// iceoryx2 0.10 may be lost.
const FIRST_WAIT: Duration = Duration::from_millis(1);
const WAIT_GROWTH: u32 = 4;
const LONGEST_WAIT: Duration = beacon::INTERVAL;
/// Requests that are on their way at a time.
const MAX_REQUESTS: usize = 64;

/// Serves a local domain until `shutdown`. `ready` is called once, when clients are waited for.
///
/// # Errors
/// [`BridgeError`], in particular where a daemon or another bridge serves the domain.
pub fn run(options: &Options, shutdown: &AtomicBool, ready: impl FnOnce()) -> Result<(), BridgeError> {
    // What iceoryx2 reports is handled here; its own log is switched on by IOX2_LOG_LEVEL.
    set_log_level_from_env_or(LogLevel::Fatal);
    let mut lock = DomainLock::acquire_patiently(&options.domain)?;
    lock.wipe_if_unused()?;
    options.domain.create_folders()?;
    let result = HostEnd::start(options).and_then(|mut end| {
        ready();
        let result = end.serve(&mut lock, shutdown);
        end.close();
        result
    });
    // All ports, services and the node are gone by now.
    lock.withdraw()?;
    lock.wipe_if_unused()?;
    lock.remove()?;
    result
}

/// The state of the main thread. Fields are dropped in order: ports before services before the node.
struct HostEnd {
    inlets: Vec<Inlet>,
    doorbell: Doorbell,
    _metrics_server: Option<Server>,
    shared: Arc<Shared>,
    dead_nodes: DeadNodes,
    _housekeeping: Housekeeping,
}

impl HostEnd {
    fn start(options: &Options) -> Result<Self, BridgeError> {
        let housekeeping = Housekeeping::start(options.domain.clone())?;
        let node = nodes::create(&options.domain.config()?, SignalHandlingMode::Disabled)
            .map_err(|error| BridgeError::transport("creating a node", &error))?;
        memory::close_to_others(&options.domain).map_err(|source| BridgeError::System {
            what: "closing shared memory to other users".to_owned(),
            source,
        })?;
        nodes::clean_up_dead(&node);
        let doorbell = Doorbell::new(&node)?;
        let event = services::create_shared_event(&node, names::REPLY)
            .map_err(|error| BridgeError::transport("creating the reply event", &error))?;
        let notifier =
            event.notifier_builder().create().map_err(|error| BridgeError::transport("creating a notifier", &error))?;
        let random = RandomState::new();
        let shared = Arc::new(Shared {
            sessions: Sessions::default(),
            directory: Directory::default(),
            metrics: Arc::default(),
            name: options.network.name.clone(),
            max_message_bytes: options.network.max_message_bytes,
            domain: options.domain.clone(),
            instance: random.hash_one(std::process::id()),
            run: random.hash_one(Instant::now()),
            num_registered: AtomicU64::new(0),
            num_requests: AtomicUsize::new(0),
            num_openings: AtomicU64::new(0),
            random,
            network: net::open(&options.network)?,
            reply_notifier: notifier,
            _reply_event: event,
            node: Arc::new(node),
        });
        subscribe(&shared, &options.network)?;
        let report = Arc::downgrade(&shared);
        let metrics_server = options
            .metrics
            .map(|address| {
                let counts = Arc::clone(&shared.metrics);
                Server::start(address, counts, move || report.upgrade().map(|shared| status::report(&shared)))
            })
            .transpose()?;
        Ok(Self {
            inlets: Vec::new(),
            doorbell,
            _metrics_server: metrics_server,
            shared,
            dead_nodes: DeadNodes::new(&options.domain),
            _housekeeping: housekeeping,
        })
    }

    fn serve(&mut self, lock: &mut DomainLock<'_>, shutdown: &AtomicBool) -> Result<(), BridgeError> {
        let (mut wait, mut ticked) = (FIRST_WAIT, Instant::now());
        while !shutdown.load(Ordering::Relaxed) {
            let is_woken = self.doorbell.wait(wait);
            wait = if is_woken { FIRST_WAIT } else { (WAIT_GROWTH * wait).clamp(FIRST_WAIT, LONGEST_WAIT) };
            if ticked.elapsed() >= beacon::INTERVAL {
                ticked = Instant::now();
                self.tick();
            }
            self.open_or_close(lock)?;
            self.hand_out_requests();
            self.shared.sessions.for_each(|session| session.wake());
            self.end_left_sessions();
        }
        Ok(())
    }

    /// Serves requests while a daemon is there.
    fn open_or_close(&mut self, lock: &mut DomainLock<'_>) -> Result<(), BridgeError> {
        let has_daemon = self.shared.directory.has_any();
        if has_daemon != self.inlets.is_empty() {
            return Ok(());
        }
        self.shared.num_openings.fetch_add(1, Ordering::Relaxed);
        if has_daemon {
            lock.announce()?;
            self.inlets = Inlet::open_all(&self.shared.node, &self.shared.domain)?;
            tracing::info!(domain = self.shared.domain.name(), "serving");
        } else {
            self.inlets.clear();
            lock.withdraw()?;
            tracing::warn!(domain = self.shared.domain.name(), "no daemon is left: not serving");
        }
        Ok(())
    }

    fn hand_out_requests(&self) {
        for inlet in &self.inlets {
            while let Some(pending) = inlet.receive() {
                // A copy: the peer may go on writing.
                let header = *pending.user_header();
                let (shared, layout) = (Arc::clone(&self.shared), inlet.layout());
                if shared.num_requests.fetch_add(1, Ordering::Relaxed) >= MAX_REQUESTS {
                    shared.num_requests.fetch_sub(1, Ordering::Relaxed);
                    requests::refuse(&shared, &pending, &header, layout);
                    continue;
                }
                let answer = move || {
                    requests::serve(&shared, &pending, &header, layout);
                    drop(pending);
                    shared.num_requests.fetch_sub(1, Ordering::Relaxed);
                };
                if let Err(error) = std::thread::Builder::new().name("request".into()).spawn(answer) {
                    tracing::warn!(%error, "starting a thread for a request");
                    self.shared.num_requests.fetch_sub(1, Ordering::Relaxed);
                }
            }
        }
    }

    /// Four times a second: says which links are alive, and gives up those whose daemon is gone.
    fn tick(&mut self) {
        let shared = &self.shared;
        if self.dead_nodes.is_due() {
            self.dead_nodes.clean_up(&shared.node);
        }
        shared.sessions.for_each(|session| {
            if !session.has_ended() && !shared.directory.has(&session.remote) {
                count(&shared.metrics.num_lost_sessions);
                tracing::warn!(
                    session = session.id,
                    daemon = &*session.remote.daemon,
                    "the daemon of a session is gone"
                );
                session.end();
            }
        });
        for daemon in shared.directory.names() {
            let links = shared.sessions.links_to(&daemon);
            let beacon = HostBeacon { versions: Versions::own(), run: shared.run, links };
            let sent = shared
                .network
                .put(keys::host_beacon(&daemon, &shared.name), beacon::to_bytes(&beacon))
                .priority(Urgency::Signal.priority())
                .congestion_control(Urgency::Signal.congestion())
                .express(true)
                .wait();
            if let Err(error) = sent {
                tracing::debug!(%error, "sending a beacon");
            }
        }
    }

    /// Closes sessions whose host is gone.
    fn end_left_sessions(&self) {
        for session in self.shared.sessions.remove_where(|session| session.has_ended() || !session.has_host()) {
            if !session.has_ended() {
                tracing::info!(
                    session = session.id,
                    num_frames = session.num_frames(),
                    "session ended: its host is gone"
                );
                session.end();
            }
            self.shared.close(session.link, &session.remote);
        }
    }

    /// Ends all sessions, and leaves the network.
    fn close(&self) {
        for session in self.shared.sessions.remove_where(|_| true) {
            session.end();
            self.shared.close(session.link, &session.remote);
        }
        if let Err(error) = self.shared.network.close().wait() {
            tracing::debug!(%error, "leaving the network");
        }
    }
}
