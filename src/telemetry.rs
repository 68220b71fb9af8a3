//! Logs: `tracing` to standard error.

use std::io::IsTerminal;

use thiserror::Error;
use tracing_subscriber::{Layer, filter::Targets, fmt, layer::SubscriberExt, registry, util::SubscriberInitExt};

use crate::config::{LogFormat, Telemetry};

/// Why logs can't be set up.
#[derive(Debug, Error)]
pub enum TelemetryError {
    /// The filter is not valid.
    #[error("log filter `{filter}`: {source}")]
    Filter {
        /// The filter.
        filter: String,
        /// The reason.
        source: tracing_subscriber::filter::ParseError,
    },
    /// Logs were set up already.
    #[error("logs: {0}")]
    Init(#[source] Box<dyn std::error::Error + Send + Sync>),
}

/// Starts logging for this process. For programs only: a library must not choose the log of its host.
///
/// # Errors
/// [`TelemetryError`].
pub fn init(telemetry: &Telemetry) -> Result<(), TelemetryError> {
    let filter: Targets = telemetry
        .filter
        .parse()
        .map_err(|source| TelemetryError::Filter { filter: telemetry.filter.clone(), source })?;
    let lines = fmt::layer().with_writer(std::io::stderr).with_ansi(std::io::stderr().is_terminal());
    match telemetry.format {
        LogFormat::Text => registry().with(lines.with_filter(filter)).try_init(),
        LogFormat::Json => registry().with(lines.json().with_filter(filter)).try_init(),
    }
    .map_err(|error| TelemetryError::Init(Box::new(error)))
}
