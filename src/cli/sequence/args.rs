//! `--cache`, `--prim`, `--body-cache` and `--frames`.

use std::{ops::RangeInclusive, path::PathBuf, str::FromStr};

/// The group of arguments that bring in frames.
const FRAMES: &str = "frames of a shot";

/// The arguments of sequences.
#[derive(Clone, Debug, Default, clap::Args)]
pub struct CacheArgs {
    /// Positions frame by frame, while the FILEs give the mesh: .pc2, .mdd, or numbered .obj or .ply by a pattern as
    /// cloth_####.obj. Of several FILEs the vertices stand in it one file after the other
    #[arg(long, value_name = "IN", group = FRAMES)]
    pub cache: Option<PathBuf>,
    /// The meshes at and below this prim of FILE, a stage in USD (.usd, .usda, .usdc, .usdz), at all time codes of
    /// their points; fix writes a layer over FILE, .usda. Not with --cache and --layers, nor with several FILEs
    #[arg(long, value_name = "PATH", group = FRAMES)]
    pub prim: Option<String>,
    /// The same for the bodies: one for each --body, in their order, of as many frames; without any, bodies stay where
    /// they are
    #[arg(long = "body-cache", value_name = "IN", requires = FRAMES)]
    pub body_caches: Vec<PathBuf>,
    /// A part of the frames, both ends included: numbers as in the names of numbered files, from 0 in .pc2 and .mdd,
    /// time codes in USD (from 0 where these are not whole numbers in a row)
    #[arg(long, value_name = "A..B", requires = FRAMES)]
    pub frames: Option<FrameRange>,
}

impl CacheArgs {
    /// Whether frames are asked for.
    #[must_use]
    pub fn is_asked(&self) -> bool {
        self.cache.is_some() || self.prim.is_some()
    }
}

/// Frames from one to another, both included.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FrameRange(pub RangeInclusive<u64>);

impl FromStr for FrameRange {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let (first, last) = text.split_once("..").unwrap_or((text, text));
        let number = |text: &str| text.parse().ok().filter(|_| text.bytes().all(|byte| byte.is_ascii_digit()));
        match (number(first), number(last)) {
            (Some(first), Some(last)) if first <= last => Ok(Self(first..=last)),
            (Some(_), Some(_)) => Err("the first frame must not be after the last one".to_owned()),
            _ => Err("`A..B` is needed, two numbers of frames, both included".to_owned()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frame_range_takes_two_numbers_in_order_or_one() {
        let range = |text: &str| text.parse::<FrameRange>().map(|range| range.0);
        assert_eq!(range("0..12"), Ok(0..=12));
        assert_eq!(range("0007..8"), Ok(7..=8));
        assert_eq!(range("5"), Ok(5..=5));
        for bad in ["", "..", "1..", "..2", "-1..2", "2..1", "1..=2", "+1..2", "a..b", "1..2..3"] {
            assert!(range(bad).is_err(), "{bad}");
        }
    }
}
