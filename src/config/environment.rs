//! The environment as a layer: `UNTANGLED_SETTINGS__PATH_RINGS=3` is `settings.path_rings`.

use std::ffi::OsString;

use toml::{Table, Value};

use super::{error::ConfigError, explanations::EXPLANATIONS};
use crate::overlay::nearest;

const PREFIX: &str = "UNTANGLED_";

/// Values of keys, and warnings about variables that are none.
#[derive(Debug, Default)]
pub(super) struct Environment {
    /// The variable, the key and the value.
    pub(super) values: Vec<(String, &'static str, Value)>,
    pub(super) warnings: Vec<String>,
}

impl Environment {
    /// Reads variables; `defaults` tells which keys are text.
    pub(super) fn read(
        variables: impl Iterator<Item = (OsString, OsString)>,
        defaults: &Table,
    ) -> Result<Self, ConfigError> {
        let mut environment = Self::default();
        // In the order of their names, so that warnings do not change places.
        let mut ours: Vec<(String, OsString)> =
            variables.filter_map(|(name, value)| Some((name.into_string().ok()?, value))).collect();
        ours.retain(|(name, _)| name.starts_with(PREFIX));
        ours.sort();
        for (variable, value) in ours {
            let Some(key) = keys().find(|key| self::variable(key) == variable) else {
                environment.warnings.push(unknown(&variable));
                continue;
            };
            let refused = |reason: &str| ConfigError::Value {
                layer: variable.clone(),
                key: key.to_owned(),
                reason: reason.to_owned(),
            };
            let text = value.to_str().ok_or_else(|| refused("it is not UTF-8"))?;
            // As for all programs, an empty variable chooses no domain.
            if key == "domain" && text.is_empty() {
                continue;
            }
            let value = parse(text, is_text(key, defaults));
            environment.values.push((variable, key, value));
        }
        Ok(environment)
    }
}

/// All keys, sections left out.
fn keys() -> impl Iterator<Item = &'static str> {
    EXPLANATIONS.iter().map(|(key, _)| *key).filter(|key| !key.starts_with('['))
}

/// The variable of a key.
fn variable(key: &str) -> String {
    PREFIX.to_owned() + &key.replace('.', "__").to_uppercase()
}

fn unknown(name: &str) -> String {
    let variables: Vec<String> = keys().map(variable).collect();
    let hint = match nearest(name, variables.iter().map(String::as_str)) {
        Some(variable) => format!("did you mean {variable}?"),
        None => "`untangled config` lists the keys".to_owned(),
    };
    format!("environment variable {name} is not known and has no effect; {hint}")
}

/// Whether the value of a key is text by default.
fn is_text(key: &str, defaults: &Table) -> bool {
    let mut names = key.split('.');
    let first = names.next().and_then(|name| defaults.get(name));
    names.try_fold(first, |value, name| value.map(|value| value.get(name))).flatten().is_some_and(Value::is_str)
}

/// A value as TOML writes it, but text without quotes.
fn parse(text: &str, is_text: bool) -> Value {
    let parsed = || format!("value = {text}").parse::<Table>().ok()?.remove("value");
    if is_text { Value::String(text.to_owned()) } else { parsed().unwrap_or_else(|| Value::String(text.to_owned())) }
}
