//! The daemon's configuration: defaults < TOML file < environment < flags.

use std::path::PathBuf;

use clap::Args;
use figment::{
    Figment,
    providers::{Env, Format, Serialized, Toml},
};
use serde::{Deserialize, Serialize};
use thiserror::Error;
use untangled_proto::{Domain, DomainError, domain::DEFAULT_DOMAIN, limits};

use crate::settings::{Settings, SettingsError};

/// Flags that choose or change the configuration.
#[derive(Clone, Debug, Default, Args)]
pub struct ConfigFlags {
    /// Name of the domain: daemons and clients of different domains never meet.
    #[arg(long, value_name = "NAME")]
    pub domain: Option<String>,
    /// Configuration file, as printed by `untangled config`.
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
}

/// All that can be configured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Config {
    /// Name of the domain.
    pub domain: String,
    /// What sessions may ask for.
    pub limits: Limits,
    /// Logs.
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

/// Logs.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Telemetry {
    /// What to log.
    pub filter: String,
    /// Text or JSON.
    pub format: LogFormat,
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
        Self { filter: "info".to_owned(), format: LogFormat::Text }
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
    /// A limit beyond what the protocol allows.
    #[error("configuration: limits.{name} is {value}; it must be between 1 and {limit}")]
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
        let mut layers = Figment::from(Serialized::defaults(Self::default()));
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
        let config: Self = layers.extract().map_err(Box::new)?;
        config.settings.validate()?;
        let Limits { max_sessions, max_vertices, max_faces } = config.limits;
        for (name, value, limit) in [
            ("max_sessions", max_sessions, limits::MAX_SESSIONS),
            ("max_vertices", max_vertices, limits::MAX_VERTICES),
            ("max_faces", max_faces, limits::MAX_FACES),
        ] {
            if !(1..=limit).contains(&value) {
                return Err(ConfigError::Limit { name, value, limit });
            }
        }
        Ok(config)
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
        if self.settings.thickness_m.is_none() {
            out.push_str("\n\n# ");
            out.push_str(THICKNESS);
            out.push_str("\n# thickness_m = 0.001");
        }
        Ok(out)
    }
}

const THICKNESS: &str = "Thickness of the cloth in metres. Without it the mean edge length stands in.";

/// What each key means; a test compares them with the configuration.
const EXPLANATIONS: &[(&str, &str)] = &[
    ("domain", "Where clients find the daemon; different domains never meet."),
    ("[limits]", "What sessions may ask for."),
    ("limits.max_sessions", "Most sessions at a time, 1 to 64."),
    ("limits.max_vertices", "Most vertices of a session."),
    ("limits.max_faces", "Most faces of a session."),
    ("[telemetry]", "Logs, on standard error."),
    (
        "telemetry.filter",
        "What to log: a level, or per module as in `untangled=debug` (a line per frame with stage times).",
    ),
    ("telemetry.format", "`text` or `json`."),
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
        let config =
            Config { settings: Settings { thickness_m: Some(0.002), ..Settings::default() }, ..Config::default() };
        let text = config.explained().unwrap();
        assert_eq!(toml::from_str::<Config>(&text).unwrap(), config);
        let lines: Vec<&str> = text.lines().collect();
        for (k, line) in lines.iter().enumerate() {
            if line.contains(" = ") && !line.starts_with('#') {
                assert!(lines[k - 1].starts_with("# "), "{line} has no explanation");
            }
        }
        assert!(Config::default().explained().unwrap().contains("# thickness_m"));
    }
}
