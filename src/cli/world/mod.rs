//! The arguments that `check` and `fix` have in common: which files are looked at, and how.

use std::path::PathBuf;

use super::{gap::GapArgs, input::MAX_FACE_PAIRS, roles::RoleArgs, sequence::args::CacheArgs, weld::WeldArg};

/// What is looked at.
#[derive(Clone, Debug, clap::Args)]
pub struct WorldArgs {
    /// Mesh files (OBJ, PLY, STL, glTF, GLB); several are pieces in one world. With --prim one stage in USD (.usd,
    /// .usda, .usdc, .usdz)
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// Vertices in one place that are one along seams, and move as one: those in `exact`ly one place, those within so
    /// many METRES, or none (`off`)
    #[arg(long, value_name = "exact|off|METRES", default_value = "exact")]
    pub weld: WeldArg,
    /// What files are beside cloth
    #[command(flatten)]
    pub roles: RoleArgs,
    /// `--gap` and `--gap-for`.
    #[command(flatten)]
    pub gap: GapArgs,
    /// End with an error, and write nothing, where more pairs of triangles intersect: a million takes up to two
    /// gigabytes
    #[arg(long, value_name = "N", default_value_t = MAX_FACE_PAIRS, value_parser = clap::value_parser!(u64).range(1..))]
    pub max_face_pairs: u64,
    /// `--cache`, `--prim`, `--body-cache` and `--frames`.
    #[command(flatten)]
    pub sequence: CacheArgs,
}
