//! The keys of the configuration, their defaults, and their types.

use std::net::SocketAddr;

use serde::{Deserialize, Serialize};
use untangled_proto::limits;
use untangled_transport::{Domain, DomainError, domain::DEFAULT_DOMAIN};

use untangle::settings::{Quality, Settings};

use super::error::ConfigError;
use crate::service::DEFAULT_REPAIR_WORKERS;

/// Largest limit of a session's memory in megabytes, which is none: a terabyte.
pub(super) const MAX_MEMORY_MB: usize = 1_000_000;

/// The effective configuration of a process.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Config {
    /// Name of the domain.
    pub domain: String,
    /// The quality whose settings `settings` starts from.
    pub quality: Quality,
    /// Threads that work on frames; 0 for as many as there are processors.
    pub num_workers: usize,
    /// Repairs at a time.
    pub num_repair_workers: usize,
    /// The instructions that frames are computed with.
    pub instruction_set: InstructionSet,
    /// What sessions may ask for.
    pub limits: Limits,
    /// Logs and metrics.
    pub telemetry: Telemetry,
    /// Settings of sessions, where a session does not choose its own.
    pub settings: Settings,
}

/// What sessions may ask for.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Limits {
    /// Most sessions at a time.
    pub max_sessions: usize,
    /// Most sessions of one client, which is one process.
    pub max_sessions_per_client: usize,
    /// Most vertices of a session.
    pub max_vertices: usize,
    /// Most faces of a session.
    pub max_faces: usize,
    /// Most memory that a session may take in megabytes, as estimated at its registration.
    pub max_session_memory_mb: usize,
}

/// Logs and metrics.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Telemetry {
    /// What to log.
    pub filter: String,
    /// Text or JSON.
    pub format: LogFormat,
    /// Address of the metrics; empty for none.
    pub metrics: String,
}

/// The instructions that frames are computed with: answers are the same bytes with each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum InstructionSet {
    /// The best that this processor has.
    #[default]
    Best,
    /// What every processor of the architecture has.
    Portable,
}

impl InstructionSet {
    /// Chooses it for this process.
    pub fn choose(self) {
        untangle::simd::use_portable_instructions(self == Self::Portable);
    }
}

/// How logs look.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LogFormat {
    /// Lines for people.
    #[default]
    Text,
    /// One JSON object a line.
    Json,
}

impl Default for Config {
    fn default() -> Self {
        Self {
            domain: DEFAULT_DOMAIN.to_owned(),
            quality: Quality::default(),
            num_workers: 0,
            num_repair_workers: DEFAULT_REPAIR_WORKERS,
            instruction_set: InstructionSet::default(),
            limits: Limits::default(),
            telemetry: Telemetry::default(),
            settings: Settings::default(),
        }
    }
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            max_sessions: limits::MAX_SESSIONS,
            max_sessions_per_client: limits::MAX_SESSIONS,
            max_vertices: limits::MAX_VERTICES,
            max_faces: limits::MAX_FACES,
            max_session_memory_mb: MAX_MEMORY_MB,
        }
    }
}

impl Default for Telemetry {
    fn default() -> Self {
        Self { filter: "info".to_owned(), format: LogFormat::Text, metrics: String::new() }
    }
}

impl Config {
    /// The loopback address to serve metrics on, if any.
    ///
    /// # Errors
    /// [`ConfigError::Metrics`] for any other address.
    pub fn metrics(&self) -> Result<Option<SocketAddr>, ConfigError> {
        let value = &self.telemetry.metrics;
        if value.is_empty() {
            return Ok(None);
        }
        let address = value.parse::<SocketAddr>().ok().filter(|address| address.ip().is_loopback());
        address.map(Some).ok_or_else(|| ConfigError::Metrics { value: value.clone() })
    }

    /// The domain.
    ///
    /// # Errors
    /// [`DomainError`].
    pub fn domain(&self) -> Result<Domain, DomainError> {
        Domain::locate(Some(&self.domain))
    }
}
