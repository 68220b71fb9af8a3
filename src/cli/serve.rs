//! `untangled serve`.

use clap::Args;

use crate::{
    config::{Config, ConfigFlags, Telemetry},
    service::{self, ServeOptions, Shutdown},
    telemetry,
};

use super::{CliError, Outcome};

#[derive(Debug, Args)]
pub(super) struct ServeArgs {
    #[command(flatten)]
    config: ConfigFlags,
    /// What to log, as in `info` or `untangled=debug` (a span per frame with the times of its stages).
    #[arg(long, value_name = "FILTER")]
    log: Option<String>,
}

pub(super) fn run(args: &ServeArgs) -> Result<Outcome, CliError> {
    let mut config = Config::load(&args.config)?;
    if let Some(filter) = &args.log {
        config.telemetry = Telemetry { filter: filter.clone(), ..config.telemetry };
    }
    telemetry::init(&config.telemetry)?;
    let options = ServeOptions {
        domain: config.domain()?,
        max_sessions: config.limits.max_sessions,
        max_vertices: config.limits.max_vertices,
        max_faces: config.limits.max_faces,
        settings: config.settings,
    };
    service::run(&options, &Shutdown::default(), || {
        tracing::info!(domain = options.domain.name(), root = %options.domain.root().display(), "serving");
        eprintln!("ready");
        notify_systemd();
    })?;
    Ok(Outcome::Clean)
}

/// Tells systemd, where it started us with `Type=notify`, that clients can connect.
fn notify_systemd() {
    use std::os::{
        linux::net::SocketAddrExt,
        unix::net::{SocketAddr, UnixDatagram},
    };
    let Some(path) = std::env::var_os("NOTIFY_SOCKET") else { return };
    let address = match path.as_encoded_bytes().strip_prefix(b"@") {
        Some(name) => SocketAddr::from_abstract_name(name),
        None => SocketAddr::from_pathname(&path),
    };
    let sent = address.and_then(|address| UnixDatagram::unbound()?.send_to_addr(b"READY=1", &address));
    if let Err(error) = sent {
        tracing::warn!(%error, "notifying systemd");
    }
}
