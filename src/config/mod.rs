//! The daemon's configuration: defaults < TOML file < environment < flags.

use std::{net::SocketAddr, path::PathBuf};

use clap::Args;
use figment::{
    Figment,
    providers::{Env, Format, Serialized, Toml},
};
use serde::{Deserialize, Serialize};
use thiserror::Error;
use untangled_transport::{Domain, DomainError, domain::DEFAULT_DOMAIN};
use untangled_proto::limits;

use untangle::settings::{Quality, Settings, SettingsError};

/// Flags that choose or change the configuration.
#[derive(Clone, Debug, Default, Args)]
pub struct ConfigFlags {
    /// Name of the domain: daemons and clients of different domains never meet.
    #[arg(long, value_name = "NAME")]
    pub domain: Option<String>,
    /// Configuration file, as printed by `untangled config`.
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// Settings of sessions to start from, where a session does not choose: `fast`, `balanced` or `accurate`.
    #[arg(long, value_name = "NAME")]
    pub quality: Option<String>,
}

/// All that can be configured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Config {
    /// Name of the domain.
    pub domain: String,
    /// The settings that `settings` starts from.
    pub quality: Quality,
    /// Threads that work on frames; 0 for as many as there are processors.
    pub num_workers: usize,
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
    /// Most vertices of a session.
    pub max_vertices: usize,
    /// Most faces of a session.
    pub max_faces: usize,
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
            limits: Limits::default(),
            telemetry: Telemetry::default(),
            settings: Settings::default(),
        }
    }
}

impl Default for Limits {
    fn default() -> Self {
        Self { max_sessions: limits::MAX_SESSIONS, max_vertices: limits::MAX_VERTICES, max_faces: limits::MAX_FACES }
    }
}

impl Default for Telemetry {
    fn default() -> Self {
        Self { filter: "info".to_owned(), format: LogFormat::Text, metrics: String::new() }
    }
}

/// Why a configuration can't be used.
#[derive(Debug, Error)]
pub enum ConfigError {
    /// The file that was asked for is not there.
    #[error("configuration file {path}: {source}")]
    File {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// A key or a value that is not understood; says which, and from where.
    #[error("configuration: {0}")]
    Value(#[from] Box<figment::Error>),
    /// A setting out of range.
    #[error("configuration: {0}")]
    Settings(#[from] SettingsError),
    /// An address that metrics can't be served on.
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

impl Config {
    /// The effective configuration of this process.
    ///
    /// # Errors
    /// [`ConfigError`], naming the key and where its value came from.
    pub fn load(args: &ConfigFlags) -> Result<Self, ConfigError> {
        let mut layers = Figment::new();
        if let Some(path) = &args.config {
            // Read here, so that a missing file is an error and not an empty layer.
            let text =
                std::fs::read_to_string(path).map_err(|source| ConfigError::File { path: path.clone(), source })?;
            layers = layers.merge(Toml::string(&text));
        }
        // UNTANGLED_SETTINGS__PATH_RINGS=3 is settings.path_rings.
        layers = layers.merge(Env::prefixed("UNTANGLED_").split("__"));
        if let Some(domain) = &args.domain {
            layers = layers.merge(Serialized::default("domain", domain));
        }
        if let Some(quality) = &args.quality {
            layers = layers.merge(Serialized::default("quality", quality));
        }
        // What was chosen lies over the quality, and that over the defaults.
        let mut defaults = Self::default();
        if layers.contains("quality") {
            defaults.quality = layers.extract_inner("quality").map_err(Box::new)?;
            defaults.quality.apply(&mut defaults.settings);
        }
        let config: Self = Figment::from(Serialized::defaults(defaults)).merge(layers).extract().map_err(Box::new)?;
        config.settings.validate()?;
        let Limits { max_sessions, max_vertices, max_faces } = config.limits;
        for (name, value, limit) in [
            ("limits.max_sessions", max_sessions, limits::MAX_SESSIONS),
            ("limits.max_vertices", max_vertices, limits::MAX_VERTICES),
            ("limits.max_faces", max_faces, limits::MAX_FACES),
        ] {
            if !(1..=limit).contains(&value) {
                return Err(ConfigError::Limit { name, value, limit });
            }
        }
        if !(0..=MAX_WORKERS).contains(&config.num_workers) {
            let (name, value) = ("num_workers", config.num_workers);
            return Err(ConfigError::Limit { name, value, limit: MAX_WORKERS });
        }
        config.metrics()?;
        Ok(config)
    }

    /// Where metrics are to be served, if anywhere.
    ///
    /// # Errors
    /// [`ConfigError::Metrics`] for what is no loopback address.
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

    /// The configuration as a TOML file that says what each key means.
    ///
    /// # Errors
    /// [`ConfigError::Print`].
    pub fn explained(&self) -> Result<String, ConfigError> {
        let mut out = String::from(
            "# Effective configuration of untangled. Later layers win: defaults, --config FILE, environment, flags.\n\
             # In the environment a key is written UNTANGLED_SECTION__KEY, as in UNTANGLED_SETTINGS__PATH_RINGS=3.\n",
        );
        let mut section = String::new();
        for line in toml::to_string(self)?.lines() {
            if let Some(name) = line.strip_prefix('[').and_then(|line| line.strip_suffix(']')) {
                section = format!("{name}.");
            }
            let key = line.split(" = ").next().unwrap_or(line);
            let key = if line.starts_with('[') { key.to_owned() } else { format!("{section}{key}") };
            if let Some((_, explanation)) = EXPLANATIONS.iter().find(|(name, _)| *name == key) {
                out.push_str("\n# ");
                out.push_str(explanation);
            }
            out.push('\n');
            out.push_str(line);
        }
        let Settings { thickness_m, deadline_us, .. } = &self.settings;
        for (is_set, explanation, example) in [
            (thickness_m.is_some(), THICKNESS, "thickness_m = 0.001"),
            (deadline_us.is_some(), DEADLINE, "deadline_us = 8000"),
        ] {
            if !is_set {
                out.push_str("\n\n# ");
                out.push_str(explanation);
                out.push_str("\n# ");
                out.push_str(example);
            }
        }
        Ok(out)
    }
}

/// More workers than this would hardly be meant.
const MAX_WORKERS: usize = 256;

const DEADLINE: &str = "Time for a frame in microseconds; what it does not suffice for is left out, the shortest paths first. Without it there is no limit.";

const THICKNESS: &str = "Thickness of the cloth in metres. Without it the mean edge length stands in.";

/// What each key means; a test compares them with the configuration.
const EXPLANATIONS: &[(&str, &str)] = &[
    ("domain", "Where clients find the daemon; different domains never meet."),
    ("quality", "The settings below start from `fast`, `balanced` or `accurate`; a session may choose one too."),
    ("num_workers", "Threads that work on frames, at least 2; 0 for as many as there are processors."),
    ("[limits]", "What sessions may ask for."),
    ("limits.max_sessions", "Most sessions at a time, 1 to 64."),
    ("limits.max_vertices", "Most vertices of a session."),
    ("limits.max_faces", "Most faces of a session."),
    ("[telemetry]", "Logs, on standard error, and metrics."),
    (
        "telemetry.filter",
        "What to log: a level, or per module as in `untangled=debug` (a line per frame with stage times).",
    ),
    ("telemetry.format", "`text` or `json`."),
    ("telemetry.metrics", "Loopback address for metrics as Prometheus text, as in 127.0.0.1:9464; empty for none."),
    ("[settings]", "Settings of sessions, where a session does not choose its own by the same names."),
    (
        "settings.response",
        "How corrections are found: `rbf` (fit of targets), `contour` (shorter paths), `displacement` (straight to the targets) or `mask` (flags only).",
    ),
    (
        "settings.inside",
        "Which side of a path is inside: the one with fewer vertices, `count`, with less `area`, or the one that takes less `work` to bring back.",
    ),
    (
        "settings.stiffness_per_step2",
        "Part of the distance to its target that a vertex covers in a step, per unit mass and step^2.",
    ),
    ("settings.max_step_edge_lengths", "Largest correction of a vertex in a step, in mean edge lengths."),
    ("settings.thickness_m", THICKNESS),
    ("settings.deadline_us", DEADLINE),
    ("settings.layer_order", "Whether layers, where the host gave them, decide what is inside."),
    ("settings.winding", "Whether winding numbers decide what is inside, on closed and oriented pieces."),
    ("settings.pinned_outside", "Whether a side with pinned vertices is outside, where the other side has none."),
    ("settings.min_centres", "Fewest centres of a fit, 3 or more."),
    ("settings.max_centres", "Most centres of a fit, up to 1000."),
    ("settings.path_rings", "Width of the flagged surroundings of the paths, in rings of vertices, up to 64."),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_is_explained_and_the_text_reads_back() {
        let config = Config {
            settings: Settings { thickness_m: Some(0.002), deadline_us: Some(1), ..Settings::default() },
            ..Config::default()
        };
        let text = config.explained().unwrap();
        assert_eq!(toml::from_str::<Config>(&text).unwrap(), config);
        let lines: Vec<&str> = text.lines().collect();
        for (k, line) in lines.iter().enumerate() {
            if line.contains(" = ") && !line.starts_with('#') {
                assert!(lines[k - 1].starts_with("# "), "{line} has no explanation");
            }
        }
        let text = Config::default().explained().unwrap();
        assert!(text.contains("\n# thickness_m = ") && text.contains("\n# deadline_us = "));
        assert_eq!(toml::from_str::<Config>(&text).unwrap(), Config::default());
    }

    #[test]
    fn metrics_stay_on_this_machine() {
        let metrics = |value: &str| {
            let telemetry = Telemetry { metrics: value.to_owned(), ..Telemetry::default() };
            Config { telemetry, ..Config::default() }.metrics()
        };
        assert!(metrics("").unwrap().is_none());
        assert!(metrics("127.0.0.1:9464").unwrap().is_some() && metrics("[::1]:0").unwrap().is_some());
        for bad in ["0.0.0.0:9464", "192.168.0.1:80", "localhost", "9464"] {
            assert!(matches!(metrics(bad), Err(ConfigError::Metrics { .. })), "{bad}");
        }
    }
}
