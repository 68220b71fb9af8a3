//! The arguments of `untangled check`.

use std::path::PathBuf;

use crate::cli::{gap::GapArgs, input::MAX_FACE_PAIRS, roles::RoleArgs, sequence::args::CacheArgs, weld::WeldArg};

/// Finds all intersections of one mesh, or of several in one world.
///
/// Exit code: 0 without intersections, 1 with, or where vertices are inside of a body or behind an inner layer, or
/// primitives nearer than a gap that was asked for; 2 for bad input.
///
/// With --cache all frames of a sequence are checked, on all processors. --json then prints a line for each frame as
/// it is done, and the totals last (schema untangled.sequence/1); the lines are the same for any number of threads.
#[derive(Clone, Debug, clap::Args)]
pub struct CheckArgs {
    /// Mesh files (OBJ, PLY, STL, glTF, GLB); several are pieces in one world
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// Print one JSON document (schema untangled.check/1) instead of a table
    #[arg(long)]
    pub json: bool,
    /// List the intersecting pairs of triangles
    #[arg(long)]
    pub face_pairs: bool,
    /// Write the intersection paths as lines: .obj (groups by type) or .ply (colours by type)
    #[arg(long, value_name = "FILE")]
    pub contours: Option<PathBuf>,
    /// Write a page to look at: one .html file with the mesh, its intersection paths and all numbers, which opens from
    /// disk and needs no network
    #[arg(long, value_name = "FILE")]
    pub html: Option<PathBuf>,
    /// Replace the files of `--contours` and `--html` if they exist; never an input
    #[arg(long)]
    pub overwrite: bool,
    /// Say how long each stage took
    #[arg(short, long)]
    pub verbose: bool,
    /// Vertices in one place that are one along seams: those in `exact`ly one place, those within so many METRES, or
    /// none (`off`)
    #[arg(long, value_name = "exact|off|METRES", default_value = "exact")]
    pub weld: WeldArg,
    /// `--gap` and `--gap-for`.
    #[command(flatten)]
    pub gap: GapArgs,
    /// What files are beside cloth
    #[command(flatten)]
    pub roles: RoleArgs,
    /// End with an error where more pairs of triangles intersect: a million takes up to two gigabytes
    #[arg(long, value_name = "N", default_value_t = MAX_FACE_PAIRS, value_parser = clap::value_parser!(u64).range(1..))]
    pub max_face_pairs: u64,
    /// `--cache`, `--body-cache` and `--frames`.
    #[command(flatten)]
    pub sequence: CacheArgs,
}
