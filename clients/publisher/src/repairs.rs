//! What this host does with repairs: it waits for one that is going to come, and continues from where it leads.

use std::{str::FromStr, time::Duration};

use serde_json::{Value, json};
use untangled_client::{Repair, RepairError, Session};

use crate::{
    mesh::{Vec3, to_f32},
    solver::Solver,
};

/// Which frames the daemon shall repair.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RepairPolicy {
    /// None.
    Never,
    /// Those at which a tangle has not shrunk for some frames.
    #[default]
    Auto,
    /// Each in which something intersects.
    Always,
}

impl FromStr for RepairPolicy {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        match name {
            "never" => Ok(Self::Never),
            "auto" => Ok(Self::Auto),
            "always" => Ok(Self::Always),
            _ => Err("expected never, auto or always".to_owned()),
        }
    }
}

impl RepairPolicy {
    /// Adds what the daemon has to know to settings that do not say it themselves.
    #[must_use]
    pub fn complete(self, settings: &Value, most: Duration) -> Value {
        let mut settings = if settings.is_null() { json!({}) } else { settings.clone() };
        let name = match self {
            Self::Never => return settings,
            Self::Auto => "auto",
            Self::Always => "always",
        };
        if let Value::Object(settings) = &mut settings {
            settings.entry("repair").or_insert_with(|| json!(name));
            // A part of the time is left for the check and the way back.
            let micros = u64::try_from(most.mul_f64(0.75).as_micros()).unwrap_or(u64::MAX).max(1);
            settings.entry("repair_deadline_us").or_insert_with(|| json!(micros));
        }
        settings
    }
}

/// Waits for the repair of a frame and continues from the state that it leads to. Gives back whether it came, and
/// whether nothing intersects in that state.
///
/// The state is exactly that of the frame, since nothing moves meanwhile; so this host has the very bits that the
/// daemon checked. A simulator that does not wait adds the displacements to the positions of the time at which
/// [`Session::poll_repair`] has them.
///
/// # Errors
/// [`RepairError`] for errors that would repeat in the next frame.
pub(crate) fn take(
    session: &mut Session,
    solver: &mut Solver,
    frame: u64,
    deadline: Duration,
) -> Result<Option<bool>, RepairError> {
    let repair = match session.wait_repair(frame, deadline) {
        Ok(repair) => repair,
        Err(RepairError::Refused(refusal)) if refusal.is_transient() => return Ok(None),
        Err(RepairError::Timeout { .. } | RepairError::DaemonLost { .. } | RepairError::Overtaken { .. }) => {
            return Ok(None);
        }
        Err(error) => return Err(error),
    };
    solver.place(&repaired(&solver.cloth().positions, &repair));
    Ok(Some(repair.is_certified()))
}

/// The sums as this host has them, in the precision in which it publishes.
fn repaired(positions: &[Vec3], repair: &Repair) -> Vec<Vec3> {
    let steps = repair.displacements_f32().unwrap_or_default();
    let sum =
        |(position, step): (&Vec3, &[f32; 3])| Vec3::from_fn(|axis, _| f64::from(to_f32(position[axis]) + step[axis]));
    positions.iter().zip(steps).map(sum).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn complete_leaves_what_the_settings_say() {
        let second = Duration::from_secs(1);
        assert_eq!(RepairPolicy::Never.complete(&Value::Null, second), json!({}));
        let auto = json!({"repair": "auto", "repair_deadline_us": 750_000});
        assert_eq!(RepairPolicy::Auto.complete(&Value::Null, second), auto);
        let chosen = json!({"repair": "asked", "quality": "fast", "repair_deadline_us": 7});
        assert_eq!(RepairPolicy::Always.complete(&chosen, second), chosen);
        assert!("sometimes".parse::<RepairPolicy>().is_err() && "auto".parse() == Ok(RepairPolicy::Auto));
    }
}
