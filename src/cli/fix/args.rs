//! The arguments of `untangled fix`.

use std::{path::PathBuf, time::Duration};

use clap::ValueEnum;

use untangle::relax::{Effort, RelaxSettings};

use crate::cli::world::WorldArgs;

/// Untangle mesh files: move vertices until nothing intersects, and write everything else back as it was.
///
/// Vertex k of the output is vertex k of the input; polygons, materials, groups, normals and comments stay. A clean
/// input is written unchanged. What is written is read back and checked exactly before it takes its place; inputs are
/// never overwritten. Ctrl-C ends the work and writes nothing.
///
/// The extension of OUT decides its format. OBJ from OBJ, PLY from PLY, STL from STL and glTF or GLB from glTF or GLB
/// keep all that is not geometry, and so do several OBJ in one OBJ; any other combination keeps vertices, polygons and
/// texture coordinates. STL is only written from one STL, glTF only from one glTF; a buffer of it that changed, or
/// that would not be found from the folder of OUT, is embedded. Other files that an input names (materials, images) are
/// named as before, and looked for beside OUT.
///
/// With --cache the frames of a sequence are repaired, coherent in time: each correction is carried to the frames
/// beside it, and fades out over 8 of them; a frame that was clean and needs no such fade is written bit for bit. OUT
/// is of the format of the cache, each frame certified as it is written. Until the end it is called OUT.partial, beside
/// OUT.journal (numbered meshes get their names one by one): after Ctrl-C or a crash the same command goes on from
/// there. --frames A..B writes that part, with the bytes that the whole has there, so that several machines can share
/// the work: parts of numbered meshes are the files of the whole, and need no joining; a part as .pc2 or .mdd is a
/// cache of those frames, which `untangled join` joins. --json prints a line for each frame as it is done, and the
/// totals last (schema untangled.sequence/1).
///
/// With --prim the frames are those of the meshes of FILE, a stage in USD, at a prim and below it; FILE stays as it is,
/// and OUT is a layer over it that says the points alone. Parts of it are joined with the tools of USD, as the manual
/// shows. --prim takes one FILE, and so no --layers; neither it nor --cache goes with --time-limit.
///
/// Exit code: 0 clean; 1 intersections remain, vertices inside of a body or behind an inner layer, or primitives nearer
/// than the gap, and OUT is the best state found; 2 bad input or usage, another error, or Ctrl-C.
#[derive(Clone, Debug, clap::Args)]
pub struct FixArgs {
    /// The files, and how they are looked at.
    #[command(flatten)]
    pub world: WorldArgs,
    /// File to write (.obj, .ply, .stl, .gltf, .glb), with the pieces in order; or a folder, for one file per input
    /// under its own name; with --cache a file or pattern of the same format as that; with --prim a layer of USD as
    /// text (.usda, .usd)
    #[arg(short, long, value_name = "OUT")]
    pub out: PathBuf,
    /// Print one JSON document (schema untangled.fix/1) instead of lines for people
    #[arg(long)]
    pub json: bool,
    /// Write the JSON document to a file
    #[arg(long, value_name = "FILE")]
    pub report: Option<PathBuf>,
    /// Write a page to look at: one .html file with the mesh before and after, its intersection paths, how far it moved
    /// and was stretched, and all numbers, which opens from disk and needs no network
    #[arg(long, value_name = "FILE")]
    pub html: Option<PathBuf>,
    /// Give up after this many iterations
    #[arg(long, value_name = "N", default_value_t = RelaxSettings::default().max_iterations)]
    pub max_iterations: usize,
    /// End the untangling so many seconds after the start, and write the best state found until then
    #[arg(long, value_name = "SECONDS", value_parser = seconds, allow_negative_numbers = true)]
    pub time_limit: Option<Duration>,
    /// Time against result
    #[arg(long, value_enum, default_value_t)]
    pub quality: QualityArg,
    /// Keep vertices where they are: a file of 0-based indices separated by white space, with # comments; of several
    /// FILEs together, pieces in order
    #[arg(long, value_name = "FILE")]
    pub pin: Option<PathBuf>,
    /// Replace OUT (and the report, and the page) if it exists; never an input
    #[arg(long)]
    pub overwrite: bool,
}

fn seconds(text: &str) -> Result<Duration, String> {
    let value = text.parse().map_err(|_| "must be a number of seconds".to_owned())?;
    Duration::try_from_secs_f64(value).map_err(|_| "must be a number of seconds, 0 or more".to_owned())
}

/// [`Effort`] as an argument.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum QualityArg {
    /// Fewest candidates a step
    Fast,
    /// In between
    #[default]
    Balanced,
    /// Most candidates a step where progress stalls, otherwise as balanced
    Accurate,
}

impl From<QualityArg> for Effort {
    fn from(quality: QualityArg) -> Self {
        match quality {
            QualityArg::Fast => Self::Fast,
            QualityArg::Balanced => Self::Balanced,
            QualityArg::Accurate => Self::Accurate,
        }
    }
}
