//! `untangled serve`.

use clap::Args;
use sd_notify::NotifyState;

use crate::{
    config::{Config, ConfigFlags, Telemetry},
    service::{self, ServeOptions, Shutdown},
    telemetry,
};

use super::outcome::{CliError, Outcome};

#[derive(Debug, Args)]
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
    let mut config = Config::load(&args.config)?;
    if let Some(filter) = &args.log {
        config.telemetry = Telemetry { filter: filter.clone(), ..config.telemetry };
    }
    if let Some(metrics) = &args.metrics {
        config.telemetry.metrics.clone_from(metrics);
    }
    config.instruction_set.choose();
    telemetry::init(&config.telemetry)?;
    let options = ServeOptions {
        domain: config.domain()?,
        max_sessions: config.limits.max_sessions,
        max_vertices: config.limits.max_vertices,
        max_faces: config.limits.max_faces,
        num_workers: config.num_workers,
        metrics: config.metrics()?,
        settings: config.settings,
    };
    service::run(&options, &Shutdown::default(), || {
        tracing::info!(domain = options.domain.name(), root = %options.domain.root().display(), "serving");
        eprintln!("ready");
        notify_systemd(NotifyState::Ready);
    })?;
    notify_systemd(NotifyState::Stopping);
    Ok(Outcome::Clean)
}

/// Notifies systemd, if it started this process with `Type=notify`.
fn notify_systemd(state: NotifyState<'_>) {
    if let Err(error) = sd_notify::notify(false, &[state]) {
        tracing::warn!(%error, "notifying systemd");
    }
}
