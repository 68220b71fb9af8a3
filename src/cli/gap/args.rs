//! The arguments.

use std::io::{self, Write};

use super::presets::{LARGEST_M, Preset};

/// `--gap` and `--gap-for`.
#[derive(Clone, Debug, Default, clap::Args)]
pub struct GapArgs {
    /// The distance that primitives (vertex and face, edge and edge) without a common vertex keep, in metres: those
    /// that are nearer count, and end with exit code 1; `fix` sets them apart
    #[arg(long, value_name = "METRES", value_parser = metres, allow_negative_numbers = true)]
    pub gap: Option<f64>,
    /// The gap that a solver needs, by its own numbers in metres: ppf (contact_gap=0.001, contact_offset=0: two of
    /// both), libuipc (thickness=0.001: more than two), newton (margin=0.005, gap=0: the sum)
    #[arg(long, value_name = "TOOL[:NAME=METRES,...]", conflicts_with = "gap")]
    pub gap_for: Option<Preset>,
}

/// A distance that was asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct Asked {
    /// In metres; positive and finite.
    pub distance_m: f64,
    /// The tool that needs it, if that was asked for.
    pub preset: Option<Preset>,
}

fn metres(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|metres: &f64| *metres > 0.0 && *metres <= LARGEST_M)
        .ok_or_else(|| "a positive distance in metres is needed, at most 2^250".to_owned())
}

impl GapArgs {
    /// The distance that was asked for, if one was. Says on standard error what was taken for a tool.
    pub(in crate::cli) fn asked(&self) -> Option<Asked> {
        if let Some(preset) = &self.gap_for {
            // Nobody may be there to read it.
            let _ = writeln!(io::stderr(), "untangled: {preset}");
            return Some(Asked { distance_m: preset.distance_m, preset: Some(preset.clone()) });
        }
        self.gap.map(|distance_m| Asked { distance_m, preset: None })
    }
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;

    #[derive(Debug, Parser)]
    struct Program {
        #[command(flatten)]
        gap: GapArgs,
    }

    fn parse(arguments: &[&str]) -> Result<Option<Asked>, clap::Error> {
        Program::try_parse_from([&["program"], arguments].concat()).map(|program| program.gap.asked())
    }

    #[test]
    fn gap_takes_a_positive_distance_or_a_tool_and_not_both() {
        assert_eq!(parse(&[]).unwrap(), None);
        assert_eq!(parse(&["--gap", "1e-3"]).unwrap(), Some(Asked { distance_m: 1e-3, preset: None }));
        let asked = parse(&["--gap-for", "ppf"]).unwrap().unwrap();
        assert!((asked.distance_m - 0.002).abs() < 1e-15 && asked.preset.is_some());
        for bad in ["0", "-1", "nan", "inf", "1e200", "1mm", ""] {
            assert!(parse(&["--gap", bad]).is_err(), "{bad}");
        }
        assert!(parse(&["--gap-for", "bullet"]).is_err());
        assert!(parse(&["--gap", "1", "--gap-for", "ppf"]).is_err());
    }
}
