//! The rules of tools that refuse or advise against states whose primitives are too close.

use std::{
    fmt::{self, Display, Formatter},
    str::FromStr,
};

use serde::Serialize;

/// The largest distance: that of coordinates.
pub(super) const LARGEST_M: f64 = f64::from_bits((1023 + 250) << 52);

/// A tool with a rule of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Tool {
    /// ppf-contact-solver: pairs nearer than their two contact offsets are refused, and a clearance of two contact gaps
    /// is the least that it advises.
    Ppf,
    /// libuipc: a pair fails when its squared distance is at most the square of the sum of its two thicknesses.
    Libuipc,
    /// Newton (VBD, self-contact): a vertex and a triangle, or two edges, push each other where they are nearer than
    /// the margin; contacts are looked for within the gap beyond it.
    Newton,
}

impl Tool {
    const ALL: [Self; 3] = [Self::Ppf, Self::Libuipc, Self::Newton];

    fn name(self) -> &'static str {
        match self {
            Self::Ppf => "ppf",
            Self::Libuipc => "libuipc",
            Self::Newton => "newton",
        }
    }

    /// The numbers of the tool by its own names, each with its default in metres.
    fn numbers(self) -> &'static [(&'static str, f64)] {
        match self {
            Self::Ppf => &[("contact_gap", 0.001), ("contact_offset", 0.0)],
            Self::Libuipc => &[("thickness", 0.001)],
            Self::Newton => &[("margin", 0.005), ("gap", 0.0)],
        }
    }

    /// The distance that the tool needs, for both of a pair with the same numbers, in metres.
    fn distance_m(self, numbers: &[f64]) -> f64 {
        match *numbers {
            [contact_gap, contact_offset] if self == Self::Ppf => 2.0 * contact_gap + 2.0 * contact_offset,
            // Strictly more is needed, in the arithmetic of the tool.
            [thickness] if self == Self::Libuipc => 2.0 * thickness * (1.0 + STRICTLY_MORE),
            _ => numbers.iter().sum(),
        }
    }
}

/// The part by which a distance exceeds one that must be exceeded: far more than the rounding of squares in double
/// precision, and more than that in single precision.
const STRICTLY_MORE: f64 = 1e-6;

/// A tool with its numbers, and the distance that follows.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Preset {
    /// The tool.
    pub tool: Tool,
    /// Its numbers in metres, by its own names.
    pub numbers: Vec<(&'static str, f64)>,
    /// The distance that it needs, in metres.
    pub distance_m: f64,
}

impl FromStr for Preset {
    type Err = String;

    /// `TOOL` or `TOOL:NAME=METRES,...`.
    fn from_str(text: &str) -> Result<Self, String> {
        let (name, given) = text.split_once(':').map_or((text, None), |(name, given)| (name, Some(given)));
        let tool = Tool::ALL
            .into_iter()
            .find(|tool| tool.name() == name)
            .ok_or_else(|| format!("`{name}` is no tool with a rule here: ppf, libuipc or newton"))?;
        let mut numbers = tool.numbers().to_vec();
        let mut seen: Vec<&str> = Vec::new();
        for assignment in given.into_iter().flat_map(|given| given.split(',')) {
            let names = || tool.numbers().iter().map(|(name, _)| *name).collect::<Vec<_>>().join(" and ");
            let (key, value) =
                assignment.split_once('=').ok_or_else(|| format!("`{assignment}`: NAME=METRES is needed"))?;
            let number = numbers
                .iter_mut()
                .find(|(name, _)| *name == key)
                .ok_or_else(|| format!("`{key}` is no number of {name}, which has {}", names()))?;
            if seen.contains(&key) {
                return Err(format!("`{key}` is given twice"));
            }
            seen.push(key);
            number.1 = value
                .parse()
                .ok()
                .filter(|metres: &f64| metres.is_finite() && *metres >= 0.0)
                .ok_or_else(|| format!("`{value}`: {key} must be a distance in metres, 0 or more"))?;
        }
        let distance_m = tool.distance_m(&numbers.iter().map(|(_, metres)| *metres).collect::<Vec<_>>());
        if !(distance_m > 0.0 && distance_m <= LARGEST_M) {
            return Err(format!("{name} needs no distance with these numbers, or one beyond the range of coordinates"));
        }
        Ok(Self { tool, numbers, distance_m })
    }
}

impl Display for Preset {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let numbers: Vec<String> = self.numbers.iter().map(|(name, metres)| format!("{name} {metres} m")).collect();
        write!(f, "{} with {}: --gap {}", self.tool.name(), numbers.join(", "), self.distance_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn distance(text: &str) -> f64 {
        text.parse::<Preset>().unwrap_or_else(|error| panic!("{text}: {error}")).distance_m
    }

    #[test]
    fn preset_of_each_tool_follows_its_rule_and_its_defaults() {
        for (text, expected) in [
            ("ppf", 0.002),
            ("ppf:contact_gap=0.003", 0.006),
            ("ppf:contact_gap=0.001,contact_offset=0.0005", 0.003),
            ("newton", 0.005),
            ("newton:margin=0.001,gap=0.002", 0.003),
        ] {
            assert!((distance(text) - expected).abs() < 1e-15, "{text}");
        }
    }

    #[test]
    fn preset_of_libuipc_is_strictly_more_than_two_thicknesses_in_either_precision() {
        for thickness in [1e-6, 0.001, 0.1, 7.0] {
            let distance = distance(&format!("libuipc:thickness={thickness}"));
            assert!(distance * distance > (thickness + thickness) * (thickness + thickness));
            #[expect(clippy::cast_possible_truncation, reason = "as a tool in single precision does")]
            let [distance, thickness] = [distance as f32, thickness as f32];
            assert!(distance * distance > (thickness + thickness) * (thickness + thickness));
        }
    }

    #[test]
    fn preset_of_an_unknown_tool_or_number_or_a_bad_value_says_so() {
        for (text, part) in [
            ("houdini", "`houdini` is no tool"),
            ("", "ppf, libuipc or newton"),
            ("libuipc:d_hat=1", "which has thickness"),
            ("ppf:contact_gap", "NAME=METRES"),
            ("ppf:contact_gap=nan", "in metres"),
            ("ppf:contact_gap=-1", "in metres"),
            ("ppf:contact_gap=inf", "in metres"),
            ("ppf:contact_gap=0.1,contact_gap=0.2", "`contact_gap` is given twice"),
            ("libuipc:", "NAME=METRES"),
            ("libuipc:thickness=0", "needs no distance"),
            ("libuipc:thickness=1e300", "beyond the range"),
        ] {
            let error = text.parse::<Preset>().unwrap_err();
            assert!(error.contains(part), "{text}: {error}");
        }
    }
}
