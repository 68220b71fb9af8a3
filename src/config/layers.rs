//! The layers of the configuration. Later layers win: defaults, configuration file, environment, flags.

use std::path::{Path, PathBuf};

use clap::Args;
use figment::{
    Error, Figment, Metadata, Profile, Provider,
    providers::{Env, Serialized},
    value::{Dict, Map},
};
use untangled_proto::limits;

use super::{
    error::ConfigError,
    keys::{Config, InstructionSet, Limits},
};

/// Most workers; a larger number is taken for a mistake.
const MAX_WORKERS: usize = 256;

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

/// A configuration file as a layer. Read by the same crate that prints the configuration; figment's own reader would
/// bring another version of it, and take a missing file for an empty layer.
struct TomlFile {
    path: PathBuf,
    keys: toml::Table,
}

impl TomlFile {
    fn read(path: &Path) -> Result<Self, ConfigError> {
        let path = path.to_owned();
        match std::fs::read_to_string(&path) {
            Ok(text) => match text.parse() {
                Ok(keys) => Ok(Self { path, keys }),
                Err(source) => Err(ConfigError::Toml { path, source: Box::new(source) }),
            },
            Err(source) => Err(ConfigError::File { path, source }),
        }
    }
}

impl Provider for TomlFile {
    fn metadata(&self) -> Metadata {
        Metadata::named(self.path.display().to_string())
    }

    fn data(&self) -> Result<Map<Profile, Dict>, Error> {
        Serialized::defaults(&self.keys).data()
    }
}

impl InstructionSet {
    /// The one that the environment names, for commands that read no other configuration.
    ///
    /// # Errors
    /// [`ConfigError`], naming the key and its value.
    pub fn from_environment() -> Result<Self, ConfigError> {
        let environment = Figment::from(Env::prefixed("UNTANGLED_").only(&["instruction_set"]));
        if !environment.contains("instruction_set") {
            return Ok(Self::default());
        }
        Ok(environment.extract_inner("instruction_set").map_err(Box::new)?)
    }
}

impl Config {
    /// The effective configuration of this process.
    ///
    /// # Errors
    /// [`ConfigError`], naming the key and where its value came from.
    pub fn load(args: &ConfigFlags) -> Result<Self, ConfigError> {
        let mut layers = Figment::new();
        if let Some(path) = &args.config {
            layers = layers.merge(TomlFile::read(path)?);
        }
        // UNTANGLED_SETTINGS__PATH_RINGS=3 is settings.path_rings.
        layers = layers.merge(Env::prefixed("UNTANGLED_").split("__"));
        if let Some(domain) = &args.domain {
            layers = layers.merge(Serialized::default("domain", domain));
        }
        if let Some(quality) = &args.quality {
            layers = layers.merge(Serialized::default("quality", quality));
        }
        // Values that were chosen override those of the quality, which override the defaults.
        let mut defaults = Self::default();
        if layers.contains("quality") {
            defaults.quality = layers.extract_inner("quality").map_err(Box::new)?;
            defaults.quality.apply(&mut defaults.settings);
        }
        let config: Self = Figment::from(Serialized::defaults(defaults)).merge(layers).extract().map_err(Box::new)?;
        config.validate()?;
        Ok(config)
    }

    /// Checks all values against their ranges.
    fn validate(&self) -> Result<(), ConfigError> {
        self.settings.validate()?;
        let Limits { max_sessions, max_vertices, max_faces } = self.limits;
        for (name, value, limit) in [
            ("limits.max_sessions", max_sessions, limits::MAX_SESSIONS),
            ("limits.max_vertices", max_vertices, limits::MAX_VERTICES),
            ("limits.max_faces", max_faces, limits::MAX_FACES),
        ] {
            if !(1..=limit).contains(&value) {
                return Err(ConfigError::Limit { name, value, limit });
            }
        }
        if !(0..=MAX_WORKERS).contains(&self.num_workers) {
            let (name, value) = ("num_workers", self.num_workers);
            return Err(ConfigError::Limit { name, value, limit: MAX_WORKERS });
        }
        self.metrics()?;
        Ok(())
    }
}
