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
    /// The file is not TOML.
    #[error("configuration file {path}: {source}")]
    Toml {
        /// The file.
        path: PathBuf,
        /// The error of the parser, with the line.
        source: Box<toml::de::Error>,
    },
    /// A key or a value that is not understood; the message names both and their layer.
    #[error("configuration: {0}")]
    Value(#[from] Box<figment::Error>),
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
    /// The configuration can't be written down.
    #[error("configuration: {0}")]
    Print(#[from] toml::ser::Error),
}
