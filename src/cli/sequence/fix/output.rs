//! The output of a sequence while it grows: nothing that bears its name is half.

use std::{
    collections::BTreeSet,
    fs::{self, File, OpenOptions},
    io,
    ops::{Range, RangeInclusive},
    os::unix::fs::{FileExt, MetadataExt},
    path::{Path, PathBuf},
};

use untangled_mesh_io::{Pattern, UsdError, VertexCache};

use super::journal::{Entry, beside};
use crate::cli::{
    fix::{Interrupt, Target},
    sequence::{error::SequenceError, shot::Shot},
};

/// Where frames are written.
#[derive(Debug)]
pub(super) enum Output {
    /// All frames in one file, which gets its name at the end.
    One(OneFile),
    /// A file for each frame.
    Numbered {
        /// Their names.
        pattern: Pattern,
        /// Whether files of that name may be replaced.
        overwrite: bool,
    },
}

/// A file that grows.
#[derive(Debug)]
pub(super) struct OneFile {
    target: Target,
    partial: PathBuf,
    file: File,
    header: Vec<u8>,
    first: u64,
    frame_size: usize,
    /// Whether it becomes a layer of USD, which is written at the end.
    is_layer: bool,
}

impl Output {
    /// Plans an output; nothing is written yet but an empty partial file.
    pub(super) fn new(shot: &Shot, out: &Path, overwrite: bool, inputs: &[PathBuf]) -> Result<Self, SequenceError> {
        let error = |reason: &str| SequenceError::Target { path: out.to_path_buf(), reason: reason.to_owned() };
        let kind = |path: &Path| path.extension().map(|kind| kind.to_string_lossy().to_ascii_lowercase());
        let is_layer = shot.cache.is_usd();
        if is_layer && !matches!(kind(out).as_deref(), Some("usda" | "usd")) {
            return Err(error("what goes over a stage of USD is written as text, .usda"));
        }
        if !is_layer && kind(out) != kind(shot.cache.path())
            || Pattern::is_meant_by(out) != shot.cache.pattern().is_some()
        {
            return Err(error(
                "must be of the format of the cache: .pc2, .mdd, or numbered meshes by a pattern with #",
            ));
        }
        if shot.cache.pattern().is_some() {
            let pattern = Pattern::new(out).map_err(|source| error(&source.to_string()))?;
            if !pattern.folder().is_dir() {
                return Err(error("there is no such folder"));
            }
            return Ok(Self::Numbered { pattern, overwrite });
        }
        let inputs: Vec<&Path> = inputs.iter().map(PathBuf::as_path).collect();
        let target = Target::new(out.to_path_buf(), &inputs, overwrite)?;
        shot.cache.check_layer(&target.place).map_err(|reason| error(&reason))?;
        let partial = beside(&target.place, "partial");
        let frame_size = 12 * shot.cache.read(*shot.part.start())?.positions().len();
        let open = || OpenOptions::new().read(true).write(true).create(true).truncate(false).open(&partial);
        let file = open().map_err(|source| failed(&partial, &source))?;
        let header = shot.cache.header(&shot.part);
        Ok(Self::One(OneFile { target, partial, file, header, first: *shot.part.start(), frame_size, is_layer }))
    }

    /// The journal beside it. Parts that are numbered files have one each.
    pub(super) fn journal(&self, part: &RangeInclusive<u64>) -> PathBuf {
        match self {
            Self::One(one) => beside(&one.target.place, "journal"),
            Self::Numbered { pattern, .. } => {
                let name = format!("{}-{}.journal", part.start(), part.end());
                beside(&pattern.path(), &name)
            }
        }
    }

    /// The bytes of a frame as they stand on the disk, if they are there.
    pub(super) fn read(&self, frame: u64) -> Option<Vec<u8>> {
        match self {
            Self::One(one) => {
                let mut bytes = vec![0; one.frame_size];
                one.file.read_exact_at(&mut bytes, one.offset(frame)).ok()?;
                Some(bytes)
            }
            Self::Numbered { pattern, .. } => fs::read(pattern.file(frame)).ok(),
        }
    }

    /// The first frames that the disk confirms.
    pub(super) fn confirmed(&self, first: u64, entries: Vec<Entry>) -> Vec<Entry> {
        let in_order = (first..).zip(entries).take_while(|(frame, entry)| entry.frame == *frame);
        let is_there = |(frame, entry): &(u64, Entry)| self.read(*frame).is_some_and(|bytes| entry.is_of(&bytes));
        in_order.take_while(is_there).map(|(_, entry)| entry).collect()
    }

    /// Makes room for a run that goes on at a frame. `own` are frames that an earlier run wrote: they may be replaced.
    pub(super) fn begin(
        &self,
        left: RangeInclusive<u64>,
        own: &[Entry],
        inputs: &[PathBuf],
    ) -> Result<(), SequenceError> {
        match self {
            Self::One(one) => {
                let begin = || {
                    one.file.set_len(one.offset(*left.start()))?;
                    one.file.write_all_at(&one.header, 0)
                };
                begin().map_err(|source| failed(&one.partial, &source))
            }
            Self::Numbered { pattern, overwrite } => {
                let inputs: BTreeSet<(u64, u64)> = inputs.iter().filter_map(|path| identity(path)).collect();
                left.into_iter().try_for_each(|frame| {
                    let path = pattern.file(frame);
                    let is_own =
                        || own.iter().any(|e| e.frame == frame && self.read(frame).is_some_and(|b| e.is_of(&b)));
                    may_write(&path, &inputs, *overwrite, is_own)
                        .map_err(|reason| SequenceError::Target { path: path.clone(), reason: reason.to_owned() })
                })
            }
        }
    }

    /// Writes a frame beside its place, and reads it back.
    pub(super) fn write(&self, frame: u64, bytes: &[u8]) -> Result<(), SequenceError> {
        let (path, written) = match self {
            Self::One(one) => {
                let write = || {
                    one.file.write_all_at(bytes, one.offset(frame))?;
                    Ok(self.read(frame))
                };
                (one.partial.clone(), write())
            }
            Self::Numbered { pattern, .. } => {
                let path = beside(&pattern.file(frame), "partial");
                let write = || {
                    fs::write(&path, bytes)?;
                    File::open(&path)?.sync_data()?;
                    fs::read(&path).map(Some)
                };
                let written = write();
                (path, written)
            }
        };
        match written {
            Ok(written) if written.as_deref() == Some(bytes) => Ok(()),
            Ok(_) => Err(SequenceError::ReadBack { path, frame }),
            Err(source) => Err(failed(&path, &source)),
        }
    }

    /// Puts a frame at its place, which is one step.
    pub(super) fn place(&self, frame: u64) -> Result<(), SequenceError> {
        let Self::Numbered { pattern, .. } = self else { return Ok(()) };
        let path = pattern.file(frame);
        fs::rename(beside(&path, "partial"), &path).map_err(|source| failed(&path, &source))
    }

    /// Puts the whole at its place.
    pub(super) fn finish(&self, shot: &Shot, interrupt: &Interrupt) -> Result<(), SequenceError> {
        let Self::One(one) = self else { return Ok(()) };
        if one.is_layer {
            return one.finish_layer(shot, interrupt);
        }
        let OneFile { target, partial, file, .. } = one;
        let finish = || {
            file.sync_all()?;
            if !target.overwrite {
                // A file that was created since the start is not replaced.
                fs::hard_link(partial, &target.place)?;
                return fs::remove_file(partial);
            }
            fs::rename(partial, &target.place)
        };
        finish().map_err(|source| failed(&target.path, &source))
    }
}

impl OneFile {
    fn offset(&self, frame: u64) -> u64 {
        self.header.len() as u64 + (frame - self.first) * self.frame_size as u64
    }

    /// Writes the layer of all frames, and reads it back.
    fn finish_layer(&self, shot: &Shot, interrupt: &Interrupt) -> Result<(), SequenceError> {
        let Self { target, partial, file, .. } = self;
        let mut read = |frame: u64, vertices: Range<usize>| {
            let mut bytes = vec![0; 12 * vertices.len()];
            file.read_exact_at(&mut bytes, self.offset(frame) + 12 * vertices.start as u64)?;
            Ok(bytes)
        };
        let staged = target.stage(interrupt, |out| {
            let write = shot.cache.write_layer(&target.place, &shot.part, &mut read, out);
            write.map_err(|source| target.failed(&source))
        })?;
        self.read_back(shot, staged.path()).map_err(|error| match error {
            // The layer has no name yet that means anything to anybody.
            SequenceError::Usd(fault) if fault.path == staged.path() => {
                UsdError { path: target.path.clone(), ..fault }.into()
            }
            error => error,
        })?;
        staged.persist()?;
        fs::remove_file(partial).map_err(|source| failed(partial, &source))
    }

    /// Compares what a layer brings about with the frames that were certified.
    fn read_back(&self, shot: &Shot, layer: &Path) -> Result<(), SequenceError> {
        let (_, back) = VertexCache::open_usd(layer, &shot.prim)?;
        for (frame, read) in shot.part.clone().zip(back.frames()) {
            let mut bytes = vec![0; self.frame_size];
            let source = self.file.read_exact_at(&mut bytes, self.offset(frame));
            source.map_err(|source| failed(&self.partial, &source))?;
            let (meant, read) = (shot.cache.decode(frame, bytes)?, back.read(read)?);
            let is_same = |(a, b): (&[f64; 3], &[f64; 3])| a.map(f64::to_bits) == b.map(f64::to_bits);
            if meant.positions().len() != read.positions().len()
                || !meant.positions().iter().zip(read.positions()).all(is_same)
            {
                return Err(SequenceError::ReadBack { path: self.target.path.clone(), frame });
            }
        }
        Ok(())
    }
}

/// What tells a file whatever its name is.
fn identity(path: &Path) -> Option<(u64, u64)> {
    fs::metadata(path).ok().map(|metadata| (metadata.dev(), metadata.ino()))
}

/// Whether a frame may be written to a path.
fn may_write(
    path: &Path,
    inputs: &BTreeSet<(u64, u64)>,
    overwrite: bool,
    is_own: impl FnOnce() -> bool,
) -> Result<(), &'static str> {
    let Ok(metadata) = fs::symlink_metadata(path) else { return Ok(()) };
    if identity(path).is_some_and(|file| inputs.contains(&file)) {
        return Err("is an input, and inputs are never overwritten");
    }
    if !metadata.is_file() {
        return Err("is not a regular file");
    }
    if overwrite && metadata.permissions().readonly() {
        return Err("is write-protected, and --overwrite does not replace such files");
    }
    if overwrite || is_own() { Ok(()) } else { Err("exists; --overwrite replaces it") }
}

fn failed(path: &Path, source: &io::Error) -> SequenceError {
    SequenceError::Target { path: path.to_path_buf(), reason: format!("can't be written: {source}") }
}
