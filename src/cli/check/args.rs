//! The arguments of `untangled check`.

use std::path::PathBuf;

use crate::cli::world::WorldArgs;

/// Finds all intersections of one mesh, or of several in one world.
///
/// Exit code: 0 without intersections, 1 with, or where vertices are inside of a body or behind an inner layer, or
/// primitives nearer than a gap that was asked for; 2 for bad input.
///
/// With --cache all frames of a sequence are checked, with --prim those of the meshes of a stage in USD, on all
/// processors. --json then prints a line for each frame as it is done, and the totals last (schema
/// untangled.sequence/1); the lines are the same for any number of threads. Neither goes with --face-pairs, --contours
/// and --verbose; --prim takes one FILE, and so no --layers.
#[derive(Clone, Debug, clap::Args)]
pub struct CheckArgs {
    /// The files, and how they are looked at.
    #[command(flatten)]
    pub world: WorldArgs,
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
}
