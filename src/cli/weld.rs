//! `--weld`: which vertices in one place are one vertex.

use std::{ops::Range, str::FromStr};

use untangle::{
    mesh::MeshDescription,
    weld::{Weld, WeldError},
};

/// The argument of `--weld`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum WeldArg {
    /// Vertices in exactly one place are one along seams.
    #[default]
    Exact,
    /// The indices of the file are the topology.
    Off,
    /// Vertices within this many metres are one along seams.
    Metres(f64),
}

impl FromStr for WeldArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text {
            "exact" => Ok(Self::Exact),
            "off" => Ok(Self::Off),
            _ => text
                .parse()
                .ok()
                .filter(|metres: &f64| metres.is_finite() && *metres >= 0.0)
                .map(Self::Metres)
                .ok_or_else(|| "`exact`, `off` or a distance in metres is needed".to_owned()),
        }
    }
}

impl WeldArg {
    /// The weld of a world whose files have these vertices; nothing is welded across files.
    pub(super) fn find(
        self,
        description: &MeshDescription,
        positions: &[[f64; 3]],
        file_vertices: &[Range<usize>],
    ) -> Result<Weld, WeldError> {
        match self {
            Self::Off => {
                description.validate()?;
                Ok(Weld::none(description.num_vertices))
            }
            Self::Exact => Weld::find(description, positions, file_vertices, 0.0),
            Self::Metres(metres) => Weld::find(description, positions, file_vertices, metres),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weld_arg_takes_words_and_distances_only() {
        let parsed = ["exact", "off", "0", "1e-4"].map(|text| text.parse::<WeldArg>().unwrap());
        assert_eq!(parsed, [WeldArg::Exact, WeldArg::Off, WeldArg::Metres(0.0), WeldArg::Metres(1e-4)]);
        for text in ["", "on", "-1", "nan", "inf", "1mm"] {
            assert!(text.parse::<WeldArg>().is_err(), "{text}");
        }
    }
}
