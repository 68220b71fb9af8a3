//! The run loop of a daemon end: looks after the daemon, says how it is, and takes what comes from hosts.

use std::{
    collections::hash_map::RandomState,
    hash::BuildHasher,
    sync::{
        Arc, Mutex,
        atomic::{AtomicBool, Ordering},
    },
    time::{Duration, Instant},
};

use iceoryx2::prelude::{LogLevel, set_log_level_from_env_or};
use untangled_transport::throttle::Throttle;
use zenoh::{Wait, sample::Sample};

use super::{
    hosts::Hosts,
    local::{Load, Local},
    requests,
    shared::Shared,
};
use crate::{
    error::BridgeError,
    metrics::{Server, count},
    net::{self, Urgency},
    options::Options,
    wire::{
        beacon::{self, DaemonBeacon, HostBeacon, Versions},
        keys,
        message::Envelope,
    },
};

/// How often the daemon is asked how much it has to do.
const LOAD_INTERVAL: Duration = Duration::from_secs(1);
/// How often the main thread looks whether it is asked to end.
const LONGEST_SLEEP: Duration = Duration::from_millis(50);

/// Serves hosts elsewhere until `shutdown`, whether a daemon runs here or not. `ready` is called once, when hosts can
/// connect.
///
/// # Errors
/// [`BridgeError`], in particular where an address can't be listened on.
pub fn run(options: &Options, shutdown: &AtomicBool, ready: impl FnOnce()) -> Result<(), BridgeError> {
    // What iceoryx2 reports is handled here; its own log is switched on by IOX2_LOG_LEVEL.
    set_log_level_from_env_or(LogLevel::Fatal);
    let shared = Arc::new(Shared {
        hosts: Hosts::new(options.max_sessions_per_host),
        local: Mutex::default(),
        metrics: Arc::default(),
        name: options.network.name.clone(),
        domain: options.domain.clone(),
        allowed: options.network.hosts.clone(),
        max_request_bytes: options.network.max_message_bytes,
        has_new_link: AtomicBool::new(false),
        network: net::open(&options.network)?,
    });
    listen(&shared)?;
    let report = Arc::downgrade(&shared);
    let _server = options
        .metrics
        .map(|address| {
            let counts = Arc::clone(&shared.metrics);
            Server::start(address, counts, move || report.upgrade().map(|shared| shared.report()))
        })
        .transpose()?;
    let mut watch = Watch::new(&shared);
    watch.tick();
    ready();
    while !shutdown.load(Ordering::Relaxed) {
        std::thread::sleep(LONGEST_SLEEP);
        let has_new_link = shared.has_new_link.swap(false, Ordering::Relaxed);
        if has_new_link {
            watch.asked = None;
        }
        if has_new_link || watch.ticked.elapsed() >= beacon::INTERVAL || watch.is_changed() {
            watch.tick();
        }
    }
    shared.hosts.end_all();
    shared.set_local(None);
    watch.say(0);
    shared.network.close().wait().map_err(|error| BridgeError::network("leaving the network", &error))
}

/// What the main thread does: looks after the daemon, and says how it is.
struct Watch<'a> {
    shared: &'a Arc<Shared>,
    run: u64,
    load: Load,
    asked: Option<Instant>,
    ticked: Instant,
}

impl<'a> Watch<'a> {
    fn new(shared: &'a Arc<Shared>) -> Self {
        let run = RandomState::new().hash_one(std::process::id());
        Self { shared, run, load: Load::default(), asked: None, ticked: Instant::now() }
    }

    /// Whether the daemon went away since the last tick.
    fn is_changed(&self) -> bool {
        self.shared.local().is_some_and(|local| !local.is_there())
    }

    fn tick(&mut self) {
        self.ticked = Instant::now();
        self.look_for_daemon();
        let local = self.shared.local();
        if let Some(local) = &local
            && self.asked.is_none_or(|asked| asked.elapsed() >= LOAD_INTERVAL)
        {
            self.asked = Some(Instant::now());
            self.load = local.load().unwrap_or(self.load);
        }
        self.say(local.map_or(0, |local| local.instance));
        for host in self.shared.hosts.end_left() {
            tracing::info!(host = &*host, "a host end has left");
        }
    }

    fn look_for_daemon(&mut self) {
        let shared = self.shared;
        if self.is_changed() {
            tracing::warn!(domain = shared.domain.name(), "the daemon went away");
            shared.hosts.end_all();
            shared.set_local(None);
        }
        if shared.local().is_some() {
            return;
        }
        match Local::open(&shared.domain) {
            Ok(local) => {
                tracing::info!(domain = shared.domain.name(), "the daemon is there");
                shared.set_local(Some(Arc::new(local)));
                self.asked = None;
            }
            Err(error) => tracing::debug!(%error, "looking for the daemon"),
        }
    }

    /// Sends a beacon; `instance` is 0 where there is no daemon.
    fn say(&self, instance: u64) {
        let Load { num_faces, num_workers } = self.load;
        let beacon = DaemonBeacon { versions: Versions::own(), run: self.run, instance, num_faces, num_workers };
        let sent = self
            .shared
            .network
            .put(keys::daemon_beacon(&self.shared.name), beacon::to_bytes(&beacon))
            .priority(Urgency::Signal.priority())
            .congestion_control(Urgency::Signal.congestion())
            .express(true)
            .wait();
        if let Err(error) = sent {
            tracing::debug!(%error, "sending a beacon");
        }
    }
}

/// Listens to hosts: to their beacons, requests and states.
fn listen(shared: &Arc<Shared>) -> Result<(), BridgeError> {
    let failed = |error: zenoh::Error| BridgeError::network("listening to the network", &error);
    let subscribe = |key: String, take: fn(&Shared, &Sample)| {
        // Weak, since the session of the network is a part of what is shared.
        let weak = Arc::downgrade(shared);
        let callback = move |sample: Sample| {
            if let Some(shared) = weak.upgrade() {
                take(&shared, &sample);
            }
        };
        shared.network.declare_subscriber(key).callback(callback).background().wait().map_err(failed)
    };
    subscribe(keys::host_beacon(&shared.name, "*"), hear)?;
    subscribe(keys::up(&shared.name, "*", "*"), take_message)?;
    let weak = Arc::downgrade(shared);
    let callback = move |query| {
        if let Some(shared) = weak.upgrade() {
            requests::take(&shared, query);
        }
    };
    let key = keys::requests(&shared.name, "*");
    shared.network.declare_queryable(key).callback(callback).background().wait().map_err(failed)
}

fn hear(shared: &Shared, sample: &Sample) {
    let Some(key) = keys::parse(sample.key_expr().as_str()) else { return };
    match beacon::from_bytes::<HostBeacon>(&sample.payload().to_bytes()) {
        Some(beacon) => match beacon.versions.refusal() {
            None => shared.hosts.hear(key.host, &beacon),
            Some(reason) => {
                static REFUSED: Throttle = Throttle::new();
                if let Some(num_suppressed) = REFUSED.admit() {
                    tracing::warn!(host = key.host, %reason, num_suppressed, "a host end can't be served");
                }
            }
        },
        None => count(&shared.metrics.num_rejected),
    }
}

fn take_message(shared: &Shared, sample: &Sample) {
    let bytes = sample.payload().to_bytes();
    let message = keys::parse(sample.key_expr().as_str()).zip(Envelope::read(&bytes));
    let Some((key, (envelope, body))) = message else { return count(&shared.metrics.num_rejected) };
    match shared.hosts.link(key.host, envelope.link) {
        Some(link) if key.link == envelope.link && !link.has_ended() => link.receive(envelope, body),
        _ => count(&shared.metrics.num_rejected),
    }
}
