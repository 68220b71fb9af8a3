//! What a run is about: the inputs and settings on which its output depends.

use std::{fs, path::Path, time::UNIX_EPOCH};

use super::journal::{Identity, checksum};
use crate::cli::{
    fix::FixArgs,
    sequence::{error::SequenceError, shot::Shot},
};

/// The identity of a run: small files by their contents, caches by length and time of the last change.
pub(super) fn identity(args: &FixArgs, shot: &Shot) -> Result<Identity, SequenceError> {
    let mut identity = Identity::new();
    let mut add = |name: &str, value: String| identity.insert(name.to_owned(), value);
    let files = |paths: &[&Path]| -> Result<String, SequenceError> {
        let sums = paths.iter().map(|path| match fs::read(path) {
            Ok(bytes) => Ok(checksum(&bytes)),
            Err(source) => {
                Err(SequenceError::Target { path: path.to_path_buf(), reason: format!("can't be read: {source}") })
            }
        });
        Ok(sums.collect::<Result<Vec<_>, _>>()?.join(" "))
    };
    // A stage is recognised as a cache is.
    let is_stage = |path: &&Path| shot.cache.is_usd() && shot.files.iter().any(|file| file.path() == *path);
    add("FILE or --body", files(&shot.source_files().into_iter().filter(|path| !is_stage(path)).collect::<Vec<_>>())?);
    add("--prim", format!("{:?}", args.world.sequence.prim));
    add("--pin", files(&args.pin.iter().map(AsRef::as_ref).collect::<Vec<_>>())?);
    let stamps: Vec<String> = shot.cache_files().iter().map(|path| stamp(path)).collect();
    add("--cache or --body-cache", checksum(stamps.join("\n").as_bytes()));
    add("--frames", format!("{:?}", shot.part));
    add("--layers", format!("{:?}", args.world.roles.layers));
    add("--weld", format!("{:?}", args.world.weld));
    add("--gap", format!("{:?}", args.world.gap));
    add("--quality", format!("{:?}", args.quality));
    add("--max-iterations", args.max_iterations.to_string());
    add("--max-face-pairs", args.world.max_face_pairs.to_string());
    Ok(identity)
}

/// A file by name, length and time of the last change.
fn stamp(path: &Path) -> String {
    let metadata = fs::metadata(path).ok();
    let changed = metadata.as_ref().and_then(|metadata| metadata.modified().ok());
    let changed = changed.and_then(|time| time.duration_since(UNIX_EPOCH).ok()).map(|time| time.as_nanos());
    format!("{:?} {:?} {changed:?}", path.file_name(), metadata.map(|metadata| metadata.len()))
}
