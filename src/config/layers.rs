//! The layers of the configuration. Later layers win: defaults, configuration file, environment, flags.

use std::{
    ffi::OsString,
    path::{Path, PathBuf},
};

use clap::Args;
use toml::{Table, Value};
use untangled_proto::limits;

use super::{
    environment::Environment,
    error::ConfigError,
    keys::{Config, InstructionSet, Limits, MAX_MEMORY_MB},
};
use crate::overlay;

/// Most workers; a larger number is taken for a mistake.
const MAX_WORKERS: usize = 256;
/// Most repairs at a time: as many as there are sessions.
const MAX_REPAIR_WORKERS: usize = limits::MAX_SESSIONS;

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

/// A value that was chosen: the layer, the key and the value.
type Choice = (String, String, Value);

impl InstructionSet {
    /// The one that the environment names, for commands that read no other configuration.
    ///
    /// # Errors
    /// [`ConfigError`], naming the key and its value.
    pub fn from_environment() -> Result<Self, ConfigError> {
        let variable = "UNTANGLED_INSTRUCTION_SET";
        let Some(value) = std::env::var_os(variable) else { return Ok(Self::default()) };
        let value = Value::from(value.to_string_lossy().as_ref());
        Ok(Config::default().with((variable.to_owned(), "instruction_set".to_owned(), value))?.instruction_set)
    }
}

impl Config {
    /// The effective configuration of this process, and warnings about variables that have no effect.
    ///
    /// # Errors
    /// [`ConfigError`], naming the key and where its value came from.
    pub fn load(flags: &ConfigFlags) -> Result<(Self, Vec<String>), ConfigError> {
        Self::load_with(flags, std::env::vars_os())
    }

    /// As [`load`](Self::load), with an environment of its own.
    pub(super) fn load_with(
        flags: &ConfigFlags,
        variables: impl Iterator<Item = (OsString, OsString)>,
    ) -> Result<(Self, Vec<String>), ConfigError> {
        let mut choices = Vec::new();
        if let Some(path) = &flags.config {
            flatten(&read_file(path)?, &path.display().to_string(), "", &mut choices);
        }
        let defaults = Table::try_from(Self::default())?;
        let environment = Environment::read(variables, &defaults)?;
        let variables = environment.values.into_iter();
        choices.extend(variables.map(|(variable, key, value)| (variable, key.to_owned(), value)));
        for (key, value) in [("domain", &flags.domain), ("quality", &flags.quality)] {
            let chosen = value.iter().map(|value| (format!("--{key}"), key.to_owned(), Value::from(value.as_str())));
            choices.extend(chosen);
        }
        // Values that were chosen override those of the quality, which override the defaults.
        let (qualities, others): (Vec<Choice>, Vec<Choice>) =
            choices.into_iter().partition(|(_, key, _)| key == "quality");
        let mut config = Self::default();
        let quality_is_chosen = !qualities.is_empty();
        for choice in qualities {
            config = config.with(choice)?;
        }
        if quality_is_chosen {
            config.quality.apply(&mut config.settings);
        }
        for choice in others {
            config = config.with(choice)?;
        }
        config.validate()?;
        Ok((config, environment.warnings))
    }

    fn with(&self, (layer, key, value): Choice) -> Result<Self, ConfigError> {
        let path: Vec<&str> = key.split('.').collect();
        overlay::replace(self, &path, value).map_err(|reason| ConfigError::Value { layer, key: key.clone(), reason })
    }

    /// Checks all values against their ranges.
    fn validate(&self) -> Result<(), ConfigError> {
        self.settings.validate()?;
        let Limits { max_sessions, max_sessions_per_client, max_vertices, max_faces, max_session_memory_mb } =
            self.limits;
        for (name, value, limit) in [
            ("limits.max_sessions", max_sessions, limits::MAX_SESSIONS),
            ("limits.max_sessions_per_client", max_sessions_per_client, limits::MAX_SESSIONS),
            ("limits.max_session_memory_mb", max_session_memory_mb, MAX_MEMORY_MB),
            ("limits.max_vertices", max_vertices, limits::MAX_VERTICES),
            ("limits.max_faces", max_faces, limits::MAX_FACES),
            ("num_repair_workers", self.num_repair_workers, MAX_REPAIR_WORKERS),
        ] {
            if !(1..=limit).contains(&value) {
                return Err(ConfigError::Limit { name, value, limit });
            }
        }
        if self.num_workers > MAX_WORKERS {
            return Err(ConfigError::Workers { value: self.num_workers, limit: MAX_WORKERS });
        }
        self.metrics()?;
        Ok(())
    }
}

/// A configuration file as a layer, with errors that say the line.
fn read_file(path: &Path) -> Result<Table, ConfigError> {
    let path = path.to_owned();
    let text = match std::fs::read_to_string(&path) {
        Ok(text) => text,
        Err(source) => return Err(ConfigError::File { path, source }),
    };
    let read = toml::from_str::<Config>(&text).and_then(|_| toml::from_str(&text));
    read.map_err(|error: toml::de::Error| {
        let line = error.span().map(|span| 1 + text[..span.start.min(text.len())].matches('\n').count());
        ConfigError::Toml { path, line, reason: overlay::in_words(error.message()) }
    })
}

/// Adds all values of a table to those that were chosen, each with the path of its name.
fn flatten(table: &Table, layer: &str, prefix: &str, choices: &mut Vec<Choice>) {
    for (name, value) in table {
        let key = format!("{prefix}{name}");
        match value {
            Value::Table(section) => flatten(section, layer, &format!("{key}."), choices),
            value => choices.push((layer.to_owned(), key, value.clone())),
        }
    }
}
