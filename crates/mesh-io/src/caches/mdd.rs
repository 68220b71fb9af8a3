//! MDD: big-endian; frames, points, the time of each frame in seconds, then positions in single precision.

use std::{ops::RangeInclusive, path::Path};

use super::{
    error::{CacheError, CacheErrorKind},
    singles::{self, ByteOrder, Frames, Promise},
};

/// Bytes before the times.
const COUNTS_SIZE: usize = 8;

/// An open MDD file.
#[derive(Debug)]
pub(super) struct Mdd {
    pub(super) frames: Frames,
    /// The bytes of the counts and of the times.
    header: Vec<u8>,
}

impl Mdd {
    /// Opens a file and checks its header and length.
    pub(super) fn open(path: &Path, num_vertices: usize) -> Result<Self, CacheError> {
        let error = singles::at(path);
        let read = || {
            let (file, length) = singles::open(path)?;
            let promise = promise(&singles::header_bytes(&file, COUNTS_SIZE, length)?)?;
            Ok((file, length, promise))
        };
        let (file, length, promise) = read().map_err(|kind| error((None, kind)))?;
        promise.check(num_vertices, length).map_err(&error)?;
        // The file is as long as its header promises, so the times are there.
        let size = usize::try_from(promise.header_size).unwrap_or(usize::MAX);
        let header = singles::header_bytes(&file, size, length).map_err(|kind| error((None, kind)))?;
        Ok(Self { frames: Frames::new(file, ByteOrder::Big, num_vertices, promise), header })
    }

    /// The header of a file with a part of the frames, their times as they were read.
    pub(super) fn header(&self, part: &RangeInclusive<u64>) -> Vec<u8> {
        let index = |frame: u64| usize::try_from(frame).unwrap_or(usize::MAX);
        let (first, end) = (index(*part.start()), index(*part.end()) + 1);
        let num_frames = u32::try_from(end - first).unwrap_or(u32::MAX);
        let times = &self.header[COUNTS_SIZE + 4 * first..COUNTS_SIZE + 4 * end];
        [&num_frames.to_be_bytes(), &self.header[4..COUNTS_SIZE], times].concat()
    }
}

fn promise(counts: &[u8]) -> Result<Promise, CacheErrorKind> {
    let count = |at: usize, what: &str| {
        let count = i32::from_be_bytes(std::array::from_fn(|byte| counts[at + byte]));
        u64::try_from(count).map_err(|_| CacheErrorKind::Header(format!("is no MDD file: it has {count} {what}")))
    };
    let (num_frames, num_vertices) = (count(0, "frames")?, count(4, "vertices")?);
    Ok(Promise { num_vertices, num_frames, header_size: COUNTS_SIZE as u64 + 4 * num_frames })
}
