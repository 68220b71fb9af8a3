//! `untangled serve`.

use std::{fs, io};

use clap::Args;
use sd_notify::NotifyState;
use signal_hook::{consts::SIGHUP, flag};

use crate::{
    config::{Config, ConfigFlags, Limits, Telemetry},
    service::{self, ServeOptions, Shutdown},
    telemetry,
};

use super::outcome::{CliError, Outcome};

#[derive(Debug, Args)]
#[command(after_help = "\
SIGINT, SIGTERM and SIGHUP end the daemon: the frame in work is answered, and nothing stays in shared memory. SIGHUP \
is what a terminal sends when it is closed; under `nohup` it is ignored. The configuration is read at the start only.")]
pub(super) struct ServeArgs {
    #[command(flatten)]
    config: ConfigFlags,
    /// What to log, as in `info` or `untangled=debug` (a span per frame with the times of its stages).
    #[arg(long, value_name = "FILTER")]
    log: Option<String>,
    /// Serve metrics as Prometheus text over HTTP on this loopback address, as in `127.0.0.1:9464`.
    #[arg(long, value_name = "ADDRESS")]
    metrics: Option<String>,
}

pub(super) fn run(args: &ServeArgs) -> Result<Outcome, CliError> {
    let (mut config, warnings) = Config::load(&args.config)?;
    if let Some(filter) = &args.log {
        config.telemetry = Telemetry { filter: filter.clone(), ..config.telemetry };
    }
    if let Some(metrics) = &args.metrics {
        config.telemetry.metrics.clone_from(metrics);
    }
    config.instruction_set.choose();
    let logs = telemetry::init(&config.telemetry)?;
    for warning in warnings {
        tracing::warn!("{warning}");
    }
    let Limits { max_sessions, max_sessions_per_client, max_vertices, max_faces, max_session_memory_mb } =
        config.limits;
    let options = ServeOptions {
        domain: config.domain()?,
        max_sessions,
        max_sessions_per_client,
        max_vertices,
        max_faces,
        max_session_memory_bytes: 1_000_000 * max_session_memory_mb as u64,
        num_workers: config.num_workers,
        num_repair_workers: config.num_repair_workers,
        metrics: config.metrics()?,
        settings: config.settings,
    };
    let shutdown = Shutdown::default();
    if !is_ignored(SIGHUP) {
        flag::register(SIGHUP, shutdown.flag())?;
    }
    service::run(&options, &shutdown, || {
        tracing::info!(domain = options.domain.name(), root = %options.domain.root().display(), "serving");
        logs.ready();
        notify_systemd(NotifyState::Ready);
    })?;
    notify_systemd(NotifyState::Stopping);
    tracing::info!(domain = options.domain.name(), "ended");
    Ok(Outcome::Clean)
}

/// Whether this process was started with a signal ignored, as `nohup` does.
fn is_ignored(signal: i32) -> bool {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| u64::from_str_radix(line.strip_prefix("SigIgn:")?.trim(), 16).ok());
    mask.is_some_and(|mask| mask >> (signal - 1) & 1 == 1)
}

/// Notifies systemd, if it started this process with `Type=notify`.
fn notify_systemd(state: NotifyState<'_>) {
    let notified: io::Result<()> = sd_notify::notify(false, &[state]);
    if let Err(error) = notified {
        tracing::warn!(%error, "notifying systemd");
    }
}
