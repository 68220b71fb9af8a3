//! PC2: little-endian; a header of 32 bytes (`POINTCACHE2\0`, version 1, points, first frame, frames per sample,
//! samples), then positions in single precision.

use std::{ops::RangeInclusive, path::Path};

use super::{
    error::{CacheError, CacheErrorKind},
    singles::{self, ByteOrder, Frames, Promise},
};

const MAGIC: &[u8; 12] = b"POINTCACHE2\0";
const HEADER_SIZE: usize = 32;

/// An open PC2 file.
#[derive(Debug)]
pub(super) struct Pc2 {
    pub(super) frames: Frames,
    header: Vec<u8>,
}

impl Pc2 {
    /// Opens a file and checks its header and length.
    pub(super) fn open(path: &Path, num_vertices: usize) -> Result<Self, CacheError> {
        let error = singles::at(path);
        let read = || {
            let (file, length) = singles::open(path)?;
            let header = singles::header_bytes(&file, HEADER_SIZE, length)?;
            Ok((file, length, promise(&header)?, header))
        };
        let (file, length, promise, header) = read().map_err(|kind| error((None, kind)))?;
        promise.check(num_vertices, length).map_err(error)?;
        Ok(Self { frames: Frames::new(file, ByteOrder::Little, num_vertices, promise), header })
    }

    /// The header of a file with a part of the frames; that of all frames is the one that was read.
    pub(super) fn header(&self, part: &RangeInclusive<u64>) -> Vec<u8> {
        let mut header = self.header.clone();
        let [first, last] = [*part.start(), *part.end()];
        let num_samples = u32::try_from(last - first + 1).unwrap_or(u32::MAX);
        if first > 0 {
            let [start, rate] = [20, 24].map(|at| ByteOrder::Little.single(word(&self.header, at)));
            #[expect(clippy::cast_precision_loss, reason = "counts of frames are far below 2^52")]
            let moved = f64::from(start) + f64::from(rate) * first as f64;
            #[expect(clippy::cast_possible_truncation, reason = "the header holds single precision")]
            header[20..24].copy_from_slice(&(moved as f32).to_le_bytes());
        }
        header[28..32].copy_from_slice(&num_samples.to_le_bytes());
        header
    }
}

fn promise(header: &[u8]) -> Result<Promise, CacheErrorKind> {
    let error = |what: String| Err(CacheErrorKind::Header(what));
    if !header.starts_with(MAGIC) {
        return error("is no PC2 file: it does not start with POINTCACHE2".to_owned());
    }
    let [version, num_vertices, num_frames] = [12, 16, 28].map(|at| i32::from_le_bytes(word(header, at)));
    if version != 1 {
        return error(format!("is PC2 of version {version}, and only version 1 is known"));
    }
    let count = |count: i32, what: &str| {
        u64::try_from(count).map_err(|_| CacheErrorKind::Header(format!("has {count} {what}")))
    };
    Ok(Promise {
        num_vertices: count(num_vertices, "vertices")?,
        num_frames: count(num_frames, "frames")?,
        header_size: HEADER_SIZE as u64,
    })
}

fn word(header: &[u8], at: usize) -> [u8; 4] {
    std::array::from_fn(|byte| header[at + byte])
}
