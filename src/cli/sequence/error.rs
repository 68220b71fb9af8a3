//! Why a sequence was not checked or repaired.

use std::{io, path::PathBuf};

use thiserror::Error;

use untangled_mesh_io::{CacheError, CacheErrorKind, UsdError, WriteError};

use crate::cli::{fix::FixError, gap::GapError, input::InputError};

/// Why a sequence was not finished.
#[derive(Debug, Error)]
pub enum SequenceError {
    /// A cache can't be read.
    #[error(transparent)]
    Cache(#[from] CacheError),
    /// A stage of USD can't be read.
    #[error(transparent)]
    Usd(#[from] UsdError),
    /// The mesh or a body can't be analysed.
    #[error(transparent)]
    Input(#[from] InputError),
    /// What `fix` does of a file can't be done.
    #[error(transparent)]
    Fix(#[from] FixError),
    /// A frame can't be analysed.
    #[error("{}: frame {frame}: {source}", path.display())]
    FrameInput {
        /// The cache, or the file of the frame.
        path: PathBuf,
        /// The frame.
        frame: u64,
        /// What is wrong.
        source: Box<InputError>,
    },
    /// The distances of a frame can't be counted.
    #[error("{}: frame {frame}: {source}", path.display())]
    FrameGap {
        /// The cache, or the file of the frame.
        path: PathBuf,
        /// The frame.
        frame: u64,
        /// What is wrong.
        source: GapError,
    },
    /// A frame can't be repaired.
    #[error("{}: frame {frame}: {source}", path.display())]
    FrameFix {
        /// The cache, or the file of the frame.
        path: PathBuf,
        /// The frame.
        frame: u64,
        /// What is wrong.
        source: Box<FixError>,
    },
    /// A frame can't hold other positions.
    #[error("{}: frame {frame}: {source}", path.display())]
    FrameWrite {
        /// The cache, or the file of the frame.
        path: PathBuf,
        /// The frame.
        frame: u64,
        /// What is wrong.
        source: WriteError,
    },
    /// A frame on the disk is not what was written.
    #[error("{}: frame {frame}: what was written is not what is read back", path.display())]
    ReadBack {
        /// The output.
        path: PathBuf,
        /// The frame.
        frame: u64,
    },
    /// An argument that has no meaning for a sequence.
    #[error("{argument} can't be used with --cache or --prim: {reason}")]
    Argument {
        /// The argument as it is spelled.
        argument: &'static str,
        /// Why, and what to do.
        reason: &'static str,
    },
    /// Not one body cache for each body.
    #[error("--body-cache is given {given} times for {bodies} bodies; one for each --body is needed, in their order")]
    BodyCaches {
        /// Body caches.
        given: usize,
        /// Bodies.
        bodies: usize,
    },
    /// A body cache of another length.
    #[error("{}: has {given} frames, and {} has {expected}", path.display(), cache.display())]
    BodyFrames {
        /// The body cache.
        path: PathBuf,
        /// Its frames.
        given: u64,
        /// The cache of the cloth.
        cache: PathBuf,
        /// Frames of that.
        expected: u64,
    },
    /// An output can't be written.
    #[error("{}: {reason}", path.display())]
    Target {
        /// The output.
        path: PathBuf,
        /// Why not.
        reason: String,
    },
    /// Standard output can't be written.
    #[error("standard output: {0}")]
    Print(io::Error),
}

impl SequenceError {
    /// The error of a range that a cache does not hold.
    pub(super) fn out_of_range(path: PathBuf, frame: u64, [first, last]: [u64; 2]) -> Self {
        CacheError { path, frame: Some(frame), kind: CacheErrorKind::OutOfRange { first, last } }.into()
    }
}
