//! The configuration of a process, in layers: defaults, configuration file, environment, flags.
//!
//! | module | purpose |
//! |---|---|
//! | `error` | why a configuration can't be used |
//! | `keys` | the keys, their defaults and their types |
//! | `environment` | variables as values of keys |
//! | `layers` | from files, environment and flags to the effective configuration |
//! | `explanations`, `print` | the configuration as text, each key explained |

mod environment;
mod error;
mod explanations;
mod keys;
mod layers;
mod print;
#[cfg(test)]
mod tests;

pub use error::ConfigError;
pub use keys::{Config, Limits, LogFormat, Telemetry};
pub use layers::ConfigFlags;
