//! Logs: `tracing` to standard error.

mod lines;

use std::{
    fmt::Write as _,
    io::{self, IsTerminal, Write as _},
    time::Duration,
};

use thiserror::Error;
use tracing_subscriber::{
    Layer,
    filter::Targets,
    fmt::{
        self,
        format::Writer,
        time::{FormatTime, SystemTime},
    },
    layer::SubscriberExt,
    registry,
    util::SubscriberInitExt,
};

use crate::config::{LogFormat, Telemetry};
use lines::Lines;

/// How long the end of a process waits for a reader of its last lines.
const PATIENCE: Duration = Duration::from_millis(500);

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
    /// The thread that writes could not be started.
    #[error("starting the thread that writes logs: {0}")]
    Thread(#[from] io::Error),
    /// Logs were set up already.
    #[error("logs: {0}")]
    Init(#[source] Box<dyn std::error::Error + Send + Sync>),
}

/// The log of this process. When it is dropped, lines that wait are written, as far as somebody reads them.
#[derive(Debug)]
pub struct Logs {
    lines: Lines,
    format: LogFormat,
}

/// Starts logging for this process. For programs only: a library must not choose the log of its host.
///
/// Writing a log line never fails, never panics and never waits: lines that nobody reads are dropped and counted.
///
/// # Errors
/// [`TelemetryError`].
pub fn init(telemetry: &Telemetry) -> Result<Logs, TelemetryError> {
    let filter: Targets = telemetry
        .filter
        .parse()
        .map_err(|source| TelemetryError::Filter { filter: telemetry.filter.clone(), source })?;
    let format = telemetry.format;
    let lines = Lines::start(
        io::stderr(),
        match format {
            LogFormat::Text => |dropped| format!("{dropped} log lines were dropped, since nobody read them\n"),
            LogFormat::Json => |dropped| json("WARN", "log lines were dropped, since nobody read them", Some(dropped)),
        },
    )?;
    let writer = lines.clone();
    let layer = fmt::layer()
        .with_writer(move || writer.clone())
        .with_ansi(io::stderr().is_terminal())
        // What can't be written would be reported on standard error, with a panic where that is closed.
        .log_internal_errors(false);
    match format {
        LogFormat::Text => registry().with(layer.with_filter(filter)).try_init(),
        LogFormat::Json => registry().with(layer.json().with_filter(filter)).try_init(),
    }
    .map_err(|error| TelemetryError::Init(Box::new(error)))?;
    // The report of a panic, too, must not wait for a reader.
    std::panic::set_hook(Box::new(|panic| tracing::error!("{panic}")));
    Ok(Logs { lines, format })
}

impl Logs {
    /// Says `ready`, whatever the filter: as a line of its own, or as a JSON document where logs are JSON.
    pub fn ready(&self) {
        let line = match self.format {
            LogFormat::Text => "ready\n".to_owned(),
            LogFormat::Json => json("INFO", "ready", None),
        };
        let _ = self.lines.clone().write_all(line.as_bytes());
    }
}

impl Drop for Logs {
    fn drop(&mut self) {
        self.lines.flush(PATIENCE);
    }
}

/// A line as `tracing` writes it in JSON.
fn json(level: &str, message: &str, num_dropped: Option<u64>) -> String {
    let mut timestamp = String::new();
    // Without a clock there is no time in the line.
    let _ = SystemTime.format_time(&mut Writer::new(&mut timestamp));
    let mut fields = serde_json::json!({ "message": message });
    if let Some(num_dropped) = num_dropped {
        fields["num_dropped"] = num_dropped.into();
    }
    let mut line = String::new();
    let target = module_path!();
    // Writing to a string does not fail.
    let _ = writeln!(
        line,
        "{}",
        serde_json::json!({ "timestamp": timestamp, "level": level, "fields": fields, "target": target })
    );
    line
}
