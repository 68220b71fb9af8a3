//! The configuration as text.

use untangle::settings::Settings;

use super::{
    error::ConfigError,
    explanations::{DEADLINE, EXPLANATIONS, FACE_PAIRS, REPAIR_DEADLINE, TESTED_PAIRS, THICKNESS},
    keys::Config,
};

impl Config {
    /// The configuration as a TOML file in which a comment explains each key.
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
        let Settings { thickness_m, max_face_pairs, max_tested_pairs, deadline_us, repair_deadline_us, .. } =
            &self.settings;
        for (is_set, explanation, example) in [
            (thickness_m.is_some(), THICKNESS, "thickness_m = 0.001"),
            (max_face_pairs.is_some(), FACE_PAIRS, "max_face_pairs = 1000000"),
            (max_tested_pairs.is_some(), TESTED_PAIRS, "max_tested_pairs = 100000000"),
            (deadline_us.is_some(), DEADLINE, "deadline_us = 8000"),
            (repair_deadline_us.is_some(), REPAIR_DEADLINE, "repair_deadline_us = 2000000"),
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
