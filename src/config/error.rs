//! Why a configuration can't be used.

use std::path::PathBuf;

use thiserror::Error;

use untangle::settings::SettingsError;

/// Why a configuration can't be used.
#[derive(Debug, Error)]
pub enum ConfigError {
    /// The file that was asked for can't be read.
    #[error("configuration file {path}: {source}")]
    File {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// The file is not TOML, or has a key or a value that is not understood.
    #[error("configuration file {}{}: {reason}", path.display(), line.map_or(String::new(), |line| format!(":{line}")))]
    Toml {
        /// The file.
        path: PathBuf,
        /// The line, counted from 1.
        line: Option<usize>,
        /// What is wrong there.
        reason: String,
    },
    /// A value that does not fit its key.
    #[error("{layer}: {key}: {reason}")]
    Value {
        /// Where the value came from: a file, a variable or a flag.
        layer: String,
        /// The key.
        key: String,
        /// What is wrong with the value.
        reason: String,
    },
    /// A setting out of range.
    #[error("configuration: {0}")]
    Settings(#[from] SettingsError),
    /// An address that is not a loopback address.
    #[error(
        "configuration: telemetry.metrics is `{value}`; it must be a loopback address and a port, as in 127.0.0.1:9464"
    )]
    Metrics {
        /// The value at fault.
        value: String,
    },
    /// A limit beyond what the protocol allows.
    #[error("configuration: {name} is {value}; it must be between 1 and {limit}")]
    Limit {
        /// Its name.
        name: &'static str,
        /// The value at fault.
        value: usize,
        /// The largest value.
        limit: usize,
    },
    /// More workers than make sense.
    #[error(
        "configuration: num_workers is {value}; it must be at most {limit}, or 0 for as many as there are processors"
    )]
    Workers {
        /// The value at fault.
        value: usize,
        /// The largest value.
        limit: usize,
    },
    /// The configuration can't be written down.
    #[error("configuration: {0}")]
    Print(#[from] toml::ser::Error),
}
