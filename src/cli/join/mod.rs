//! `untangled join`: parts of a vertex cache, which several machines repaired, as one file.
//!
//! `part` opens a part, `order` tells whether parts belong together; both say why not by `error`.

mod error;
mod order;
mod part;

use std::{
    io,
    path::{Path, PathBuf},
};

use super::{
    fix::{FixError, Interrupt, Target},
    outcome::{CliError, Outcome},
};
use error::JoinError;
use part::Part;

/// Join the parts of a vertex cache that `fix --cache --frames` wrote: the bytes are those of one run over all frames.
///
/// Parts are .pc2 or .mdd, of the same vertices, the earliest first, each once, and none missing between two others
/// (in .mdd, whose times may have any steps, a missing one is not noticed; a first or last one never is: compare the
/// number of frames that is printed). Numbered meshes need no joining, and parts as layers of USD are joined with its
/// own tools, as the manual shows.
///
/// Exit code: 0 joined; 2 parts that do not belong together, bad usage or another error, and nothing is written.
#[derive(Clone, Debug, clap::Args)]
pub(super) struct JoinArgs {
    /// The parts, in the order of their frames
    #[arg(required = true, value_name = "PART")]
    parts: Vec<PathBuf>,
    /// The cache of all of them, of the same format
    #[arg(short, long, value_name = "OUT")]
    out: PathBuf,
    /// Replace OUT if it exists
    #[arg(long)]
    overwrite: bool,
}

/// Joins parts; the output takes its name when it is whole.
pub(super) fn run(args: &JoinArgs) -> Result<Outcome, CliError> {
    let parts = args.parts.iter().map(|path| Part::open(path)).collect::<Result<Vec<_>, _>>()?;
    order::check(&parts)?;
    if parts[0].format.extension() != part::extension(&args.out) {
        return Err(JoinError::of(&args.out, "must be of the format of its parts").into());
    }
    let header = part::header(&parts)?;
    let inputs: Vec<&Path> = args.parts.iter().map(PathBuf::as_path).collect();
    let target = Target::new(args.out.clone(), &inputs, args.overwrite)?;
    let interrupt = Interrupt::listen().map_err(FixError::Signals)?;
    let staged = target.stage(&interrupt, |out| {
        out.write_all(&header).map_err(|source| target.failed(&source))?;
        for part in &parts {
            io::copy(&mut part.frames(), out).map_err(|source| target.failed(&source))?;
        }
        Ok(())
    })?;
    staged.persist()?;
    let num_frames: u64 = parts.iter().map(|part| part.num_frames).sum();
    super::outcome::print(&super::outcome::printable(&format!(
        "{}: {num_frames} frames of {} parts\n",
        args.out.display(),
        parts.len()
    )))?;
    Ok(Outcome::Clean)
}
