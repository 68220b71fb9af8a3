//! Runs an end: logs, signals, and systemd.

use std::{
    io::{self, IsTerminal, Write},
    sync::{Arc, atomic::AtomicBool},
};

use sd_notify::NotifyState;
use signal_hook::{consts, flag};
use tracing_subscriber::{Layer, filter::Targets, fmt, layer::SubscriberExt, registry, util::SubscriberInitExt};

use super::lines::Lines;
use crate::{
    config::{Config, LogFormat, Telemetry},
    daemon,
    error::BridgeError,
    host,
    net::{self, Side},
};

pub(super) fn run(config: &Config, side: Side) -> Result<(), BridgeError> {
    let (options, warnings) = config.options(side)?;
    if options.network.tls.is_some() {
        net::begin_with_one_thread()?;
    }
    let lines = start_log(&config.telemetry)?;
    for warning in warnings {
        tracing::warn!("{warning}");
    }
    make_room_for_descriptors();
    let shutdown = Arc::new(AtomicBool::new(false));
    for signal in [consts::SIGINT, consts::SIGTERM, consts::SIGHUP] {
        flag::register(signal, Arc::clone(&shutdown))
            .map_err(|source| BridgeError::System { what: "handling signals".to_owned(), source })?;
    }
    let ready = || {
        let (name, domain) = (options.network.name.as_str(), options.domain.name());
        tracing::info!(name, domain, ?side, "ready");
        // Whatever the filter: scripts wait for this line.
        let _ = lines.clone().write_all(b"ready\n");
        notify_systemd(NotifyState::Ready);
    };
    let result = match side {
        Side::Host => host::run(&options, &shutdown, ready),
        Side::Daemon => daemon::run(&options, &shutdown, ready),
    };
    if result.is_ok() {
        notify_systemd(NotifyState::Stopping);
        tracing::info!("ended");
    }
    lines.flush();
    result
}

fn start_log(telemetry: &Telemetry) -> Result<Lines, BridgeError> {
    let filter: Targets = telemetry
        .filter
        .parse()
        .map_err(|error| BridgeError::Config(format!("log filter `{}`: {error}", telemetry.filter)))?;
    let lines = Lines::start(io::stderr())
        .map_err(|source| BridgeError::System { what: "starting the thread that writes logs".to_owned(), source })?;
    let writer = lines.clone();
    let layer = fmt::layer()
        .with_writer(move || writer.clone())
        .with_ansi(io::stderr().is_terminal())
        .log_internal_errors(false);
    let started = match telemetry.format {
        LogFormat::Text => registry().with(layer.with_filter(filter)).try_init(),
        LogFormat::Json => registry().with(layer.json().with_filter(filter)).try_init(),
    };
    started.map_err(|error| BridgeError::Config(format!("logs: {error}")))?;
    // The report of a panic, too, must not wait for a reader.
    std::panic::set_hook(Box::new(|panic| tracing::error!("{panic}")));
    Ok(lines)
}

/// Raises the soft limit of open files to the hard one, up to what 64 sessions take.
fn make_room_for_descriptors() {
    use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};
    const NEEDED: u64 = 4096;
    let limit = getrlimit(Resource::Nofile);
    if limit.current.is_some_and(|current| current < NEEDED) {
        let most = limit.maximum.map_or(NEEDED, |maximum| maximum.min(NEEDED));
        if let Err(error) = setrlimit(Resource::Nofile, Rlimit { current: Some(most), maximum: limit.maximum }) {
            tracing::debug!(%error, most, "raising the limit of open files");
        }
    }
}

/// Notifies systemd, if it started this process with `Type=notify`.
fn notify_systemd(state: NotifyState<'_>) {
    if let Err(error) = sd_notify::notify(false, &[state]) {
        tracing::warn!(%error, "notifying systemd");
    }
}
